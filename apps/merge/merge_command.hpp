#pragma once

#include <filesystem>
#include <string>

namespace motorcade {

struct MergeOptions {
  std::filesystem::path batch{}, out{};  // `merged` in the batch's folder when empty
  std::filesystem::path against{};       // another batch to compare with; empty for none
  std::string baseline_set{};            // whose objects others are compared with; the plan's when empty
};

/// Writes results.csv, results.json, results.md and report.html of all finished tasks, and prints the most important
/// table. Returns the exit code. Failures are UserErrors.
int runMerge(const MergeOptions& options);

}  // namespace motorcade
