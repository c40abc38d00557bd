#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Slurm's own programs, found by PATH.
namespace motorcade {

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
