#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace motorcade::perf {

/// Quantiles of a series of costs, one per update, by nearest rank, so that each is the cost of some update.
struct Quantiles {
  double total = 0, median = 0, p99 = 0, max = 0;
};

inline Quantiles quantilesOf(std::span<const double> costs) {
  if (costs.empty()) return {};
  std::vector<double> sorted(costs.begin(), costs.end());
  std::ranges::sort(sorted);
  const auto rank = [&](double share) {
    return sorted[static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size()))) - 1];
  };
  Quantiles quantiles{.median = rank(0.5), .p99 = rank(0.99), .max = sorted.back()};
  for (const double cost : sorted) quantiles.total += cost;
  return quantiles;
}

}  // namespace motorcade::perf
