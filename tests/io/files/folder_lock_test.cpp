#include "io/files/folder_lock.hpp"

#include <filesystem>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/files/errors.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

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
