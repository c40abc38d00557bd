#pragma once

#include <optional>

#include "apps/tasks/batch_folder.hpp"
#include "io/files/folder_lock.hpp"

namespace motorcade {

/// Keeps a batch for one runner on this machine, and tells others which process it is.
class LocalLock {
 public:
  /// Throws OutputError where another one has it.
  explicit LocalLock(const BatchFolder& folder);
  ~LocalLock();
  LocalLock(const LocalLock&) = delete;
  LocalLock& operator=(const LocalLock&) = delete;

 private:
  std::filesystem::path note_;
  FolderLock lock_;
};

/// The process that performs the tasks of a batch without Slurm.
struct LocalRunnerNote {
  std::string host{};
  int pid = 0;
  bool here = false;  // on this machine
};
/// Empty when there is no such process.
std::optional<LocalRunnerNote> localRunnerOf(const BatchFolder& folder);

}  // namespace motorcade
