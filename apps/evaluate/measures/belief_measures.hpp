#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "apps/evaluate/comparison/object_matching.hpp"

/// Compares the estimated kinds of objects with the types of their labels.
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

/// Reliability of the existence probability. A hit is a row on a label that moves at some time. Counts all rows but
/// those in an area that the labels leave open.
Reliability existenceErrors(const std::vector<ComparedFrame>& frames);

inline constexpr std::array kAllKinds = {ObjectKind::kUnknown, ObjectKind::kCar, ObjectKind::kLargeVehicle,
                                         ObjectKind::kTwoWheeler, ObjectKind::kPedestrian};

/// The kind of a label's type; unknown for other types, such as Misc.
ObjectKind kindOfType(std::string_view type);

/// Rows by the label's kind and the reported kind.
struct KindCounts {
  std::array<std::array<int, kAllKinds.size()>, kAllKinds.size()> rows{};  // [label's kind][reported kind]
  int of(ObjectKind label, ObjectKind reported) const {
    return rows[static_cast<std::size_t>(label)][static_cast<std::size_t>(reported)];
  }
  int total() const;
  double shareRight() const;  // 0 without rows
};

/// Measures of the rows on labels that have a kind. A row of `unknown` names none: it is never right, and never wrong
/// with a high probability.
struct KindRows {
  KindCounts counts;
  Reliability named;  // of the rows that name a kind; a hit is the label's
  double log_loss_sum = 0;
  int sure_wrong = 0;
  void add(ObjectKind label, ObjectKind reported, double probability);
  /// Mean of -log p where the named kind is the label's, of -log(1 - p) where it is not, and of log 2 where none is
  /// named; 0 without rows. Files hold p to three decimals: half of one is the least distance to 0 and 1 that counts.
  double logLoss() const;
  /// Share of the rows that name a wrong kind with a probability of .95 and more; 0 without rows.
  double shareSureWrong() const;
};

/// Measures of the rows that at least nine rows of the track precede, and of the others.
struct KindErrors {
  KindRows from_tenth_row, before;
};

/// Compares the reported rows that were matched to labels which are asked for, are nearer than `to_m` and have a kind.
KindErrors kindErrors(const std::vector<ComparedFrame>& frames, double to_m);

}  // namespace motorcade
