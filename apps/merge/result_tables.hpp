#pragma once

#include <string>
#include <vector>

#include "apps/merge/groups.hpp"

namespace motorcade {

/// Marks a cell as better or worse than the value that it is compared with.
enum class Tone { kNone, kBetter, kWorse };

/// A table of texts; the first `names` columns are names, the others numbers.
struct ResultTable {
  std::string title{};
  std::vector<std::string> heads{};
  std::vector<std::vector<std::string>> rows{};
  std::size_t names = 1;
  std::vector<std::vector<Tone>> tones{};  // by row and column, for pages; none where it is empty
};

/// The table to read first, with the errors of camera and objects.
ResultTable overviewTable(const std::vector<ResultGroup>& groups);
/// Every measure of accuracy, a table for each kind, latency and cost, and the worst frames: a row for each drive and
/// set.
std::vector<ResultTable> measureTables(const std::vector<ResultGroup>& groups);

/// A number rounded to `digits` digits, without trailing zeros; `-` for no value.
std::string numberText(double value, int digits);
/// A share in percent, with its sign; `-` for no value.
std::string percentText(double share, int digits);

std::string markdownOf(const ResultTable& table);
/// HTML of a table, escaped.
std::string htmlOf(const ResultTable& table);

}  // namespace motorcade
