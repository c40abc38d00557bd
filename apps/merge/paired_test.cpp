#include "apps/merge/paired_test.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>

namespace motorcade {
namespace {

/// Twice the rank of each difference by its magnitude, so that shared ranks are whole numbers, too.
std::vector<std::size_t> doubledRanks(const std::vector<double>& differences) {
  std::vector<std::size_t> order(differences.size());
  std::iota(order.begin(), order.end(), 0);
  const auto magnitude = [&](std::size_t i) { return std::abs(differences[i]); };
  std::ranges::sort(order, {}, magnitude);
  std::vector<std::size_t> ranks(differences.size());
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin;
    while (end < order.size() && magnitude(order[end]) == magnitude(order[begin])) ++end;
    for (std::size_t i = begin; i < end; ++i) ranks[order[i]] = begin + 1 + end;  // twice the mean of begin+1 .. end
    begin = end;
  }
  return ranks;
}

/// P(sum of the ranks with a positive sign <= `positive`), all signs being equally likely.
double exactTail(const std::vector<std::size_t>& ranks, std::size_t positive) {
  const std::size_t all = std::accumulate(ranks.begin(), ranks.end(), std::size_t{0});
  std::vector<double> probability(all + 1, 0);  // of each sum so far
  probability[0] = 1;
  for (const std::size_t rank : ranks)
    for (std::size_t sum = all + 1; sum-- > 0;)
      probability[sum] = (probability[sum] + (sum >= rank ? probability[sum - rank] : 0)) / 2;
  return std::accumulate(probability.begin(), probability.begin() + static_cast<std::ptrdiff_t>(positive) + 1, 0.0);
}

/// The same by the normal distribution, with half a step (of doubled ranks: one) for continuity. The variance takes
/// shared ranks into account, as it is the sum of the ranks' squares.
double normalTail(const std::vector<std::size_t>& ranks, std::size_t positive) {
  double mean = 0, variance = 0;
  for (const std::size_t rank : ranks) {
    mean += static_cast<double>(rank) / 2;
    variance += static_cast<double>(rank * rank) / 4;
  }
  const double z = (static_cast<double>(positive) + 1 - mean) / std::sqrt(variance);
  return std::erfc(-z / std::numbers::sqrt2) / 2;
}

}  // namespace

double signedRankTest(const std::vector<double>& differences) {
  std::vector<double> nonzero = differences;
  std::erase(nonzero, 0.0);
  if (nonzero.empty()) return 1;
  const auto ranks = doubledRanks(nonzero);
  std::size_t positive = 0, negative = 0;
  for (std::size_t i = 0; i < ranks.size(); ++i) (nonzero[i] > 0 ? positive : negative) += ranks[i];
  const std::size_t smaller = std::min(positive, negative);
  const double tail = ranks.size() <= kMostExact ? exactTail(ranks, smaller) : normalTail(ranks, smaller);
  return std::min(1.0, 2 * tail);
}

std::vector<double> holmCorrected(const std::vector<double>& p_values) {
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](std::size_t i) { return p_values[i]; });
  std::vector<double> corrected(p_values.size());
  double largest = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    largest = std::max(largest, std::min(1.0, static_cast<double>(order.size() - i) * p_values[order[i]]));
    corrected[order[i]] = largest;
  }
  return corrected;
}

}  // namespace motorcade
