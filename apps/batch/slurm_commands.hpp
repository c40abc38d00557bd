#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

/// Slurm's own programs, found by PATH.
namespace motorcade {

/// Submits a script and gives the job's number. `after`: only when these jobs have ended, well or not. Throws
/// UsageError with what sbatch complains of.
std::string submitScript(const std::filesystem::path& script, const std::vector<std::string>& after);

/// The largest index of an array plus one; Slurm's default where there is no Slurm.
std::size_t largestArray();

/// Where the elements of arrays are that have not ended.
struct QueuedElement {
  std::string job{};
  std::size_t index = 0;
  std::string state{}, reason{};  // as squeue names them
};
/// Empty also where there is no Slurm, or it does not answer.
std::vector<QueuedElement> queuedElements(const std::vector<std::string>& jobs);

/// Those of the jobs that have not ended.
std::vector<std::string> queuedJobs(const std::vector<std::string>& jobs);

/// Throws UsageError with what scancel complains of.
void cancelJobs(const std::vector<std::string>& jobs);

}  // namespace motorcade
