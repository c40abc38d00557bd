#pragma once

#include <array>
#include <optional>

namespace motorcade {

/// Rows whose probability lies in one tenth of 0 ... 1, and the number of hits among them.
struct ReliabilityTenth {
  int rows = 0, hits = 0;
  double probability_sum = 0;
  double claimed() const { return probability_sum / rows; }
  double shareOfHits() const { return static_cast<double>(hits) / rows; }
};

/// A reliability diagram: it compares the rows' probabilities with the frequency of hits.
struct Reliability {
  std::array<ReliabilityTenth, 10> tenths;
  double squared_error_sum = 0;
  void add(double probability, bool hit);
  int rows() const;
  /// Mean squared difference of the probability and the outcome, 1 or 0 (Brier 1950); 0 without rows.
  double brier() const;
  /// The largest difference between a tenth's mean probability and its share of hits. Tenths of fewer than 100 rows do
  /// not count, as chance alone makes a difference there. Empty where every tenth has fewer.
  std::optional<double> largestGap() const;
};

}  // namespace motorcade
