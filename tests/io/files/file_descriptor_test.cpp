#include "io/files/file_descriptor.hpp"

#include <filesystem>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/files/errors.hpp"
#include "io/files/line_file.hpp"
#include "io/files/text_file.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class FilesThatAreNone : public testing::Test {
 protected:
  test::TemporaryFolder folder_;
  fs::path fifo() const {
    fs::path file = folder_ / "fifo";
    ::mkfifo(file.c_str(), 0600);
    return file;
  }
};

TEST_F(FilesThatAreNone, AreNotReadAndNotWaitedFor) {
  const fs::path pipe = fifo();  // without a writer: whoever opens it to read waits for ever
  EXPECT_THAT(test::messageOf<InputError>([&] { readWhole(pipe); }), HasSubstr("fifo: is a FIFO"));
  EXPECT_THAT(test::messageOf<InputError>([&] { readWhole("/dev/zero"); }), HasSubstr("/dev/zero: is a device"));
  EXPECT_THAT(test::messageOf<InputError>([&] { readWhole(folder_.path()); }), HasSubstr("is a folder"));
}

TEST_F(FilesThatAreNone, AreNotWrittenTo) {
  const fs::path pipe = fifo();
  EXPECT_THAT(test::messageOf<OutputError>([&] { LineFile out(pipe); }), HasSubstr("fifo: is a FIFO"));
  EXPECT_THAT(test::messageOf<OutputError>([&] { createOutput(folder_.path()); }), HasSubstr("is a folder"));
}

TEST(InputFile, ALinkToAFileIsRead) {
  const test::TemporaryFolder folder;
  fs::create_symlink(folder.write("calib.txt", "P0: 1"), folder / "link");
  EXPECT_EQ(readWhole(folder / "link"), "P0: 1");
}

TEST(OutputFile, ALinkIsReplacedAndWhatItPointsToStays) {
  const test::TemporaryFolder folder;
  const fs::path victim = folder.write("elsewhere/victim", "precious");
  fs::create_symlink(victim, folder / "frames.csv");
  LineFile(folder / "frames.csv").writeLine("frame");
  EXPECT_EQ(folder.read("elsewhere/victim"), "precious");
  EXPECT_FALSE(fs::is_symlink(folder / "frames.csv"));
  EXPECT_EQ(folder.read("frames.csv"), "frame\n");
}

TEST(OutputFile, WhoReadsTheFormerFileGoesOnReadingIt) {
  const test::TemporaryFolder folder;
  folder.write("frames.csv", "former");
  std::ifstream reader(folder / "frames.csv");
  LineFile(folder / "frames.csv").writeLine("new");
  std::string read;
  reader >> read;
  EXPECT_EQ(read, "former");
  EXPECT_EQ(folder.read("frames.csv"), "new\n");
  EXPECT_FALSE(fs::exists(folder / "frames.csv.new"));
}

TEST(FolderLock, ASecondWriterIsRefusedWhileTheFirstOneLives) {
  const test::TemporaryFolder folder;
  std::optional<FolderLock> first(folder.path());
  EXPECT_THAT(test::messageOf<OutputError>([&] { FolderLock second(folder.path()); }), HasSubstr("is in use"));
  first->check();
  first.reset();
  EXPECT_NO_THROW(FolderLock(folder.path()));
}

TEST(FolderLock, NoticesThatTheFolderIsRemovedRenamedOrExchanged) {
  const test::TemporaryFolder folder;
  const fs::path run = folder / "run";
  fs::create_directory(run);
  const FolderLock lock(run);
  EXPECT_NO_THROW(lock.check());
  fs::rename(run, folder / "other");
  EXPECT_THAT(test::messageOf<OutputError>([&] { lock.check(); }), HasSubstr("was removed, renamed"));
  fs::create_directory(run);  // another one of this name
  EXPECT_THROW(lock.check(), OutputError);
  fs::remove(run);
  fs::rename(folder / "other", run);
  EXPECT_NO_THROW(lock.check());
}

}  // namespace
}  // namespace motorcade
