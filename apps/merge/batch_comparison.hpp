#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "apps/merge/groups.hpp"
#include "apps/merge/result_tables.hpp"

namespace motorcade {

/// Wilcoxon's signed-rank test (Wilcoxon, Individual comparisons by ranking methods, 1945): the probability of
/// differences that are at least as one-sided as these, if either sign of each were equally likely. Zero differences
/// are left out; equal ones share the mean of their ranks. Exact for up to `kMostExact` differences, beyond by the
/// normal distribution. 1 for none.
double signedRankTest(const std::vector<double>& differences);
inline constexpr std::size_t kMostExact = 60;

/// Fewer differences cannot be significant at .05, whatever their signs: 2 / 2^5 is more.
inline constexpr std::size_t kFewestDifferences = 6;

/// Corrects p-values for the number of tests, in the given order. The probability of a single wrong rejection among all
/// then keeps its level (Holm, A simple sequentially rejective multiple test procedure, 1979).
std::vector<double> holmCorrected(const std::vector<double>& p_values);

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
