#include "io/files/file_descriptor.hpp"

#include <cerrno>
#include <cstring>
#include <string>

#include <fcntl.h>
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

}  // namespace motorcade
