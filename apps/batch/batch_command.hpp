#pragma once

#include <filesystem>

#include "apps/batch/slurm.hpp"
#include "apps/tasks/planner.hpp"

namespace motorcade {

/// The command line of `motorcade batch MANIFEST`.
struct BatchOptions {
  std::filesystem::path manifest{}, out{};
  std::filesystem::path root{};       // of the manifest's paths; its own when empty
  std::filesystem::path sequences{};  // folder for rendered scenes; in `out` when empty
  std::filesystem::path program{};    // that tasks run; this one when empty
  int jobs = 0;                       // at a time; 0 for as many as there are processors for
  int threads = 2;                    // of each run
  Selection only{};
  bool retry = false;  // what failed before
  bool slurm = false;
  SlurmOptions slurm_options{};  // its time is the limit of a task here, too
};

/// Performs the tasks of a manifest, or has Slurm perform them, and merges their results; gives the exit code. Failures
/// that concern the batch as a whole are UserErrors.
int runBatch(const BatchOptions& options);

/// The command line of `motorcade batch task`: one task of a planned batch, as an element of an array runs it.
struct BatchTaskOptions {
  std::filesystem::path batch{}, list{};
  std::size_t index = 0;     // of its line in the list, from 0
  bool only_render = false;  // its sequence alone
};
int runBatchTask(const BatchTaskOptions& options);

struct BatchStatusOptions {
  std::filesystem::path batch{}, json{};
};
/// Reports the progress of a batch, wherever it runs.
int runBatchStatus(const BatchStatusOptions& options);

/// Ends the running processes of a batch, on this machine and in Slurm; finished results stay.
int runBatchCancel(const std::filesystem::path& batch);

}  // namespace motorcade
