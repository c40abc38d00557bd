#include "io/files/file_descriptor.hpp"

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/files/errors.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

const char* kindOf(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a FIFO";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

[[noreturn]] void failToCreate(const fs::path& file) {
  throw OutputError(file.string() + ": cannot be created: " + std::strerror(errno));
}

}  // namespace

FileDescriptor::~FileDescriptor() {
  if (number_ >= 0) ::close(number_);
}

InputFile openInput(const fs::path& file) {
  FileDescriptor descriptor(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  struct stat status {};
  if (descriptor.number() < 0 || ::fstat(descriptor.number(), &status) != 0)
    throw InputError(file.string() + ": cannot be opened: " + std::strerror(errno));
  if (!S_ISREG(status.st_mode))
    throw InputError(file.string() + ": is " + kindOf(status.st_mode) + ", a regular file is needed");
  return {std::move(descriptor), static_cast<std::size_t>(status.st_size)};
}

FileDescriptor createOutput(const fs::path& file) {
  struct stat status {};
  if (::lstat(file.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISLNK(status.st_mode))
    throw OutputError(file.string() + ": is " + kindOf(status.st_mode) + ", a file cannot be made in its place");
  fs::path beside = file;
  beside += ".new";
  ::unlink(beside.c_str());
  FileDescriptor descriptor(::open(beside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (descriptor.number() < 0) failToCreate(file);
  if (::rename(beside.c_str(), file.c_str()) != 0) {
    const int why = errno;
    ::unlink(beside.c_str());
    errno = why;
    failToCreate(file);
  }
  return descriptor;
}

void makeFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw OutputError(folder.string() + ": cannot be made a folder: " + error.message());
}

FolderLock::FolderLock(const std::filesystem::path& folder)
    : folder_(folder), descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (descriptor_.number() < 0) throw OutputError(folder.string() + ": cannot be opened: " + std::strerror(errno));
  if (::flock(descriptor_.number(), LOCK_EX | LOCK_NB) == 0) return;
  if (errno == EWOULDBLOCK)
    throw OutputError(folder.string() + ": is in use by another run; wait for its end, or choose another folder");
  // The file system has no locks: the user must avoid two runs into one folder.
}

void FolderLock::check() const {
  struct stat ours {
  }, named{};
  const bool there = ::fstat(descriptor_.number(), &ours) == 0 && ::stat(folder_.c_str(), &named) == 0;
  if (!there || ours.st_ino != named.st_ino || ours.st_dev != named.st_dev)
    throw OutputError(folder_.string() +
                      ": was removed, renamed or unmounted during the run; what it held is lost here");
}

}  // namespace motorcade
