#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/merge/batch_comparison.hpp"
#include "apps/merge/groups.hpp"
#include "apps/merge/merged_batch.hpp"

/// The command `batch merge`, and the files that it writes; each function returns the content of one.
namespace motorcade {

/// The content of all files.
struct Merged {
  MergedBatch batch{};
  std::vector<ResultGroup> groups{};
  std::optional<BatchComparison> comparison{};
};

/// Tasks, groups, worst frames and the comparison.
std::string jsonOf(const Merged& merged);
/// The tables.
std::string markdownOf(const Merged& merged);
/// A page in one file, with the tables and charts.
std::string pageOf(const Merged& merged);

/// Tables of published figures that the batch's drives have, with means and sources.
std::vector<ResultTable> publishedSection(const Merged& merged);
/// Drives that are not on the disk.
ResultTable leftOutTable(const MergedBatch& batch);
/// Frames to look at, of one kind of `value`.
ResultTable worstFrameTable(const std::string& title, const std::string& value, const std::vector<WorstFrame>& frames);

struct MergeOptions {
  std::filesystem::path batch{}, out{};  // `merged` in the batch's folder when empty
  std::filesystem::path against{};       // another batch to compare with; empty for none
  std::string baseline_set{};            // whose objects others are compared with; the plan's when empty
};

/// Writes results.csv, results.json, results.md and report.html of all finished tasks, and prints the most important
/// table. Returns the exit code. Failures are UserErrors.
int runMerge(const MergeOptions& options);

}  // namespace motorcade
