#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/batch/slurm_commands.hpp"
#include "apps/batch/slurm_script.hpp"
#include "apps/tasks/batch_folder.hpp"
#include "apps/tasks/plan.hpp"

namespace motorcade {

/// Arrays that were submitted together, in a folder of their own, cluster/N.
struct SlurmSubmission {
  std::filesystem::path folder{};
  struct Job {
    std::string id{};
    SlurmArray array{};  // empty, of count 0, for the job that merges
  };
  std::vector<Job> jobs{};
};

/// Writes the scripts for these tasks, one array for the scenes that must be rendered before, and submits them; the
/// results are merged when all have ended. What was submitted is noted before the next is. Throws UsageError where
/// Slurm refuses, OutputError.
SlurmSubmission submitTasks(const std::vector<const Task*>& tasks, const BatchFolder& folder,
                            const SlurmOptions& options);

/// All submissions of a batch, the first one first.
std::vector<SlurmSubmission> readSubmissions(const BatchFolder& folder);

/// What Slurm says of tasks of a batch that have not ended, by their names. No value where it does not answer.
std::optional<std::map<std::string, QueuedElement>> queuedTasks(const BatchFolder& folder);

/// The names of tasks in a list, by line.
std::vector<std::string> readTaskList(const std::filesystem::path& list);

}  // namespace motorcade
