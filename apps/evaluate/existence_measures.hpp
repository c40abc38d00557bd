#pragma once

#include <array>
#include <optional>
#include <vector>

#include "apps/evaluate/object_matching.hpp"

/// Is what is reported there as often as its rows say?
namespace motorcade {

/// Rows whose existence probability lies in one tenth of 0 ... 1, and how many of them are on what moves at some time.
struct ExistenceTenth {
  int rows = 0, real = 0;
  double probability_sum = 0;
  double claimed() const { return probability_sum / rows; }
  double shareReal() const { return static_cast<double>(real) / rows; }
};

struct ExistenceErrors {
  std::array<ExistenceTenth, 10> tenths;
  double squared_error_sum = 0;
  int rows() const;
  /// Mean squared difference of the probability and what is there, 1 or 0 (Brier 1950); 0 without rows.
  double brier() const;
  /// The largest difference between what a tenth claims and its share that is real. Tenths of fewer than 100 rows do
  /// not count, as chance alone makes one there; empty where no tenth has as many.
  std::optional<double> largestGap() const;
};

/// Counts all rows but those in an area that the labels leave open.
ExistenceErrors existenceErrors(const std::vector<ComparedFrame>& frames);

}  // namespace motorcade
