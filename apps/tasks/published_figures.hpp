#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace motorcade {

/// A published figure, to stand beside a measure of the same definition.
struct PublishedFigure {
  std::string method{}, measure{};    // the measure as a column of results.csv
  std::vector<std::string> drives{};  // by their names; of several, the figure is the mean
  std::vector<int> frames{};          // that each of them has; 0 where that is not told
  double value = 0;
  std::string source{};  // paper and table
  std::string note{};    // what differs in how it was measured; may be empty
};

/// Reads the figures of one data set from a file (docs/formats.md). Throws UsageError naming file, line, key and how to
/// fix it; a figure without a source is refused.
std::vector<PublishedFigure> readPublishedFigures(const std::filesystem::path& file, const std::string& dataset);

}  // namespace motorcade
