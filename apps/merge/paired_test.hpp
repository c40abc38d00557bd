#pragma once

#include <vector>

namespace motorcade {

/// Wilcoxon's signed-rank test (Wilcoxon, Individual comparisons by ranking methods, 1945): how likely differences as
/// one-sided as these are, or more, where each could as well have had the other sign. Differences that are zero say
/// nothing and are left out; equal ones share the mean of their ranks. Exact for up to `kMostExact` differences, beyond
/// by the normal distribution. 1 for none.
double signedRankTest(const std::vector<double>& differences);
inline constexpr std::size_t kMostExact = 60;

/// Fewer differences cannot be significant at .05, whatever their signs: 2 / 2^5 is more.
inline constexpr std::size_t kFewestDifferences = 6;

/// Corrected for the number of tests, so that the chance of a single wrong rejection among all stays what it says
/// (Holm, A simple sequentially rejective multiple test procedure, 1979); in the order given.
std::vector<double> holmCorrected(const std::vector<double>& p_values);

}  // namespace motorcade
