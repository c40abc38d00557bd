#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Slurm: its forms of times, the scripts that it is given, and its own programs, found by PATH.
namespace motorcade {

/// A time limit in one of Slurm's forms: minutes, minutes:seconds, hours:minutes:seconds, days-hours,
/// days-hours:minutes, days-hours:minutes:seconds; 0 for an empty text. Throws UsageError.
std::chrono::seconds taskTime(const std::string& text);

/// The user's options for Slurm.
struct SlurmOptions {
  std::string partition{}, time{};  // as sbatch takes them; its defaults when empty
  int array_limit = 0;              // tasks at the same time; 0 for as many as there is room for
  int memory_mb = 2000;             // of each task
  bool dry_run = false;             // scripts are printed, nothing is submitted
};

/// An array of tasks: element i performs the task in line `first` + i, counted from 0, of a list of names.
struct SlurmArray {
  std::string name{};  // of the job, and of its files: render-0, tasks-0, ...
  std::filesystem::path list{};
  std::size_t first = 0, count = 0;
  bool only_render = false;
};

/// Scripts for sbatch, with all options as #SBATCH lines. `program` is this program's file, `batch` the folder of the
/// batch, `submission` that of the submission, for logs; all are absolute.
struct SlurmScripts {
  std::filesystem::path program{}, batch{}, submission{};
  int threads = 2;
  SlurmOptions options{};

  std::string array(const SlurmArray& array) const;
  /// The script that merges the results when all arrays have ended.
  std::string merge() const;
};

/// Throws UsageError where a path has a character that an #SBATCH line cannot hold.
void requireWritableInScript(const std::filesystem::path& path);

/// Submits a script and returns the job's number. It starts only when the jobs `after` have ended, well or not. Throws
/// UsageError with sbatch's message.
std::string submitScript(const std::filesystem::path& script, const std::vector<std::string>& after);

/// The largest index of an array plus one; Slurm's default where there is no Slurm.
std::size_t largestArray();

/// An element of an array, or a job without any, that has not ended.
struct QueuedElement {
  std::string job{};
  std::size_t index = 0;          // in its array
  std::string state{}, reason{};  // as squeue names them
};
/// The queued elements of these jobs. No value where there is no Slurm, or it does not answer.
std::optional<std::vector<QueuedElement>> queuedElements(const std::vector<std::string>& jobs);

/// Throws UsageError with scancel's message.
void cancelJobs(const std::vector<std::string>& jobs);

}  // namespace motorcade
