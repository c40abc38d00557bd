#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "apps/merge/groups.hpp"
#include "apps/merge/result_tables.hpp"

namespace motorcade {

/// Difference of one measure between two batches, over their pairs of the same drive, set and seed.
struct MeasureComparison {
  std::string_view measure{};
  std::size_t pairs = 0, better = 0, worse = 0;  // the others are the same
  double median_change = 0;                      // relative, of ours against the other batch
  double p = 1, corrected_p = 1;                 // of Wilcoxon's signed-rank test; corrected by Holm
  std::string verdict{};
};

/// A result that is worse than before by more than `kWorthTelling`.
struct Regression {
  std::string result{};  // drive, seed and set
  std::string_view measure{};
  double before = 0, now = 0;
  double change = 0;
};
inline constexpr double kWorthTelling = 0.02;

struct BatchComparison {
  std::filesystem::path against{};
  std::vector<MeasureComparison> measures{};
  std::vector<Regression> regressions{};  // the worst first; of accuracy, as times are never the same
  std::vector<std::string> unpaired{};    // results that one of both lacks
};

/// Compares two batches. Where each has a single set, the sets' names need not agree.
BatchComparison compareBatches(const std::vector<ResultGroup>& ours, const std::vector<ResultGroup>& others,
                               const std::filesystem::path& against);

/// (now - before) / mean of both: also where one is zero, and the same in both directions.
double relativeChange(double before, double now);

ResultTable testTable(const BatchComparison& comparison);
ResultTable regressionTable(const BatchComparison& comparison);

}  // namespace motorcade
