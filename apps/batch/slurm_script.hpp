#pragma once

#include <filesystem>
#include <string>

namespace motorcade {

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

}  // namespace motorcade
