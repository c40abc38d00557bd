#include "io/stream/stoppable_input.hpp"

#include <array>
#include <chrono>
#include <string>
#include <thread>

#include <fcntl.h>
#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "tests/io/stream/piped_text.hpp"

namespace motorcade {
namespace {

using test::Pipe;

std::string textOf(StoppableInput& input, std::size_t bytes) {
  std::vector<std::uint8_t> text(bytes);
  text.resize(input.read(text));
  return {text.begin(), text.end()};
}

TEST(StoppableInput, ReadsLinesAndBytesInTurn) {
  Pipe pipe;
  StoppableInput input(pipe.reader(), "pipe");
  ASSERT_TRUE(pipe.write("first\nbytessecond\nlast"));
  pipe.close();
  EXPECT_EQ(input.readLine(100), "first\n");
  EXPECT_EQ(textOf(input, 5), "bytes");
  EXPECT_EQ(input.readLine(100), "second\n");
  EXPECT_EQ(textOf(input, 9), "last");
  EXPECT_EQ(textOf(input, 9), "");
  EXPECT_EQ(input.readLine(100), "");
}

TEST(StoppableInput, GivesUpALineWithoutAnEnd) {
  Pipe pipe;
  StoppableInput input(pipe.reader(), "pipe");
  ASSERT_TRUE(pipe.write(std::string(1000, 'x')));
  EXPECT_EQ(input.readLine(300), std::string(300, 'x'));
}

TEST(StoppableInput, WaitsForBytesThatComePieceByPiece) {
  Pipe pipe;
  StoppableInput input(pipe.reader(), "pipe");
  const std::jthread writer([&] {
    for (const char letter : std::string("piecewise")) {
      pipe.write(std::string(1, letter));
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  EXPECT_EQ(textOf(input, 9), "piecewise");
}

TEST(StoppableInput, EndsItsWaitOnASilentPipeWhenItIsStopped) {
  const Pipe pipe;
  StoppableInput input(pipe.reader(), "pipe");
  const std::jthread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    input.stop();
  });
  EXPECT_EQ(textOf(input, 1), "");
  EXPECT_TRUE(input.stopped());
  EXPECT_EQ(input.readLine(100), "") << "from then on nothing is waited for";
}

TEST(StoppableInput, ReadsAPipeThatDoesNotBlock) {
  const Pipe pipe;
  ASSERT_EQ(::fcntl(pipe.reader(), F_SETFL, O_NONBLOCK), 0);
  StoppableInput input(pipe.reader(), "pipe");
  const std::jthread writer([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    pipe.write("late\n");
  });
  EXPECT_EQ(input.readLine(100), "late\n");
}

TEST(StoppableInput, RefusesWhatCannotBeRead) {
  const Pipe pipe;
  EXPECT_THROW(StoppableInput(-1, "pipe"), InputError);
  EXPECT_THROW(StoppableInput(pipe.writer(), "pipe"), InputError);
}

}  // namespace
}  // namespace motorcade
