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
  /// Between what is claimed and the share that is real, in tenths with so many rows that chance makes less of it;
  /// empty where no tenth has.
  std::optional<double> largestGap() const;
};

/// Over all rows but those in an area that the labels leave open.
ExistenceErrors existenceErrors(const std::vector<ComparedFrame>& frames);

}  // namespace motorcade
