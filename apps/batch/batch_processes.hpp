#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/tasks/batch_folder.hpp"
#include "io/files/file_descriptor.hpp"

/// The processes that work on a batch: its one runner on this machine, and attempts at its tasks.
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

// The folders of attempts that are under way, or that a killed process left: TASK~WHO.

/// WHO of a task that this process performs in one of its slots: HOST-PID-SLOT.
std::string localAttemptName(std::size_t slot);
/// WHO of a task that Slurm has this process perform, slurm-JOB_INDEX-RESTART-PID; empty outside of Slurm. When a node
/// was lost for a while, two processes may perform the same element.
std::string slurmAttemptName();

struct Attempt {
  std::filesystem::path folder{};
  std::string task{}, who{};
  bool alive = true;  // as far as this machine can tell
  bool bySlurm() const { return who.starts_with("slurm-"); }
};
/// All of a batch, in the order of their tasks.
std::vector<Attempt> attemptsOf(const BatchFolder& folder);

/// Removes attempts of this machine's processes that are no longer alive, from this folder and that of the sequences.
void removeDeadAttempts(const std::filesystem::path& folder);
/// Removes what an element of an array left before Slurm restarted it, as its node was lost. If the earlier process
/// still runs, it fails and does no harm.
void removeEarlierRestarts(const BatchFolder& folder, const std::string& slurm_attempt);

}  // namespace motorcade
