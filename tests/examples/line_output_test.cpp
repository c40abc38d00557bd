#include "line_output.hpp"

#include <array>
#include <csignal>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

namespace vehicle_stack {
namespace {

class LineOutputTest : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(::pipe(ends_.data()), 0);
    std::signal(SIGPIPE, SIG_IGN);
  }
  void TearDown() override {
    for (const int end : ends_)
      if (end >= 0) ::close(end);
  }

  std::array<int, 2> ends_{-1, -1};
};

TEST_F(LineOutputTest, ALineIsWritten) {
  LineOutput output(ends_[1]);
  output.publish("a line\n");
  std::array<char, 16> read{};
  EXPECT_EQ(::read(ends_[0], read.data(), read.size()), 7);
  EXPECT_STREQ(read.data(), "a line\n");
  EXPECT_EQ(output.leftOut(), 0);
}

/// It would hang here if a full pipe held it up.
TEST_F(LineOutputTest, AReaderThatReadsNothingCostsLinesAndNoTime) {
  LineOutput output(ends_[1]);
  std::string line(4096, 'x');
  line.back() = '\n';
  for (int i = 0; i < 40; ++i) output.publish(line);
  EXPECT_EQ(output.leftOut(), 40 - 16);  // a pipe holds 64 KiB
  EXPECT_FALSE(output.readerIsGone());
}

TEST_F(LineOutputTest, AReaderThatIsGoneIsSeen) {
  LineOutput output(ends_[1]);
  ::close(ends_[0]);
  ends_[0] = -1;
  output.publish("a line\n");
  EXPECT_TRUE(output.readerIsGone());
}

}  // namespace
}  // namespace vehicle_stack
