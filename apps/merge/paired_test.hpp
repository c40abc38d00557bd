#pragma once

#include <vector>

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

}  // namespace motorcade
