#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "apps/evaluate/comparison/object_matching.hpp"
#include "apps/evaluate/measures/reliability.hpp"

/// Compares the estimated kinds of objects with the types of their labels.
namespace motorcade {

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
