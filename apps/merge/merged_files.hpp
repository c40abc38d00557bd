#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/merge/batch_comparison.hpp"
#include "apps/merge/groups.hpp"
#include "apps/merge/merged_batch.hpp"

/// Files of a merged batch; each function returns the content of one.
namespace motorcade {

/// The content of all files.
struct Merged {
  MergedBatch batch{};
  std::vector<ResultGroup> groups{};
  std::optional<BatchComparison> comparison{};
};

/// A row for each task, with every measure.
std::string csvOf(const Merged& merged);
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
/// Tasks without a result, and the reasons.
ResultTable unfinishedTable(const MergedBatch& batch);
/// Frames to look at, of one kind of `value`.
ResultTable worstFrameTable(const std::string& title, const std::string& value, const std::vector<WorstFrame>& frames);

}  // namespace motorcade
