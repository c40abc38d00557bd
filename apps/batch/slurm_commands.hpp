#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Slurm's own programs, found by PATH.
namespace motorcade {

/// Submits a script and gives the job's number. `after`: only when these jobs have ended, well or not. Throws
/// UsageError with what sbatch complains of.
std::string submitScript(const std::filesystem::path& script, const std::vector<std::string>& after);

/// The largest index of an array plus one; Slurm's default where there is no Slurm.
std::size_t largestArray();

/// An element of an array, or a job without any, that has not ended.
struct QueuedElement {
  std::string job{};
  std::size_t index = 0;          // in its array
  std::string state{}, reason{};  // as squeue names them
};
/// Those of these jobs. No value where there is no Slurm, or it does not answer.
std::optional<std::vector<QueuedElement>> queuedElements(const std::vector<std::string>& jobs);

/// Throws UsageError with what scancel complains of.
void cancelJobs(const std::vector<std::string>& jobs);

}  // namespace motorcade
