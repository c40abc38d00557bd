#pragma once

#include <filesystem>
#include <string>

namespace motorcade {

struct MergeOptions {
  std::filesystem::path batch{}, out{};  // BATCH/merged when empty
  std::filesystem::path against{};       // another batch to compare with; empty for none
  std::string baseline_set{};            // the plan's when empty
};

/// Writes tables and a page of all results of a batch; gives the exit code.
int runMerge(const MergeOptions& options);

}  // namespace motorcade
