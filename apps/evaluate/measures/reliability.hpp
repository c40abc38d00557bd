#pragma once

#include <array>
#include <optional>

namespace motorcade {

/// Rows whose probability lies in one tenth of 0 ... 1, and how many of them are as they say.
struct ReliabilityTenth {
  int rows = 0, hits = 0;
  double probability_sum = 0;
  double claimed() const { return probability_sum / rows; }
  double shareOfHits() const { return static_cast<double>(hits) / rows; }
};

/// A reliability diagram: do things happen as often as rows say?
struct Reliability {
  std::array<ReliabilityTenth, 10> tenths;
  double squared_error_sum = 0;
  void add(double probability, bool hit);
  int rows() const;
  /// Mean squared difference of the probability and what is so, 1 or 0 (Brier 1950); 0 without rows.
  double brier() const;
  /// The largest difference between what a tenth claims and its share of hits. Tenths of fewer than 100 rows do not
  /// count, as chance alone makes one there; empty where no tenth has as many.
  std::optional<double> largestGap() const;
};

}  // namespace motorcade
