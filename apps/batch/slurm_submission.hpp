#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/batch/slurm.hpp"
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

/// Writes the scripts for these tasks and submits them. Scenes to be rendered first get an array of their own, and the
/// results are merged when all have ended. Each submission is noted before the next is made. Throws UsageError where
/// Slurm refuses, and OutputError.
SlurmSubmission submitTasks(const std::vector<const Task*>& tasks, const BatchFolder& folder,
                            const SlurmOptions& options);

/// All submissions of a batch, the first one first.
std::vector<SlurmSubmission> readSubmissions(const BatchFolder& folder);

/// Slurm's state of the tasks of a batch that have not ended, by their names. Empty where Slurm does not answer.
std::optional<std::map<std::string, QueuedElement>> queuedTasks(const BatchFolder& folder);

/// The names of tasks in a list, by line.
std::vector<std::string> readTaskList(const std::filesystem::path& list);

}  // namespace motorcade
