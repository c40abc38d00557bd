#include "io/files/folder_lock.hpp"

#include <cerrno>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include "io/files/errors.hpp"

namespace motorcade {

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
