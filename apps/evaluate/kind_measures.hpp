#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "apps/evaluate/object_matching.hpp"

/// What objects are taken for, against the types of their labels.
namespace motorcade {

inline constexpr std::array kAllKinds = {ObjectKind::kUnknown, ObjectKind::kCar, ObjectKind::kLargeVehicle,
                                         ObjectKind::kTwoWheeler, ObjectKind::kPedestrian};

/// The kind of a label's type; unknown for types that are none of them, such as Misc.
ObjectKind kindOfType(std::string_view type);

/// How many rows of labels of a kind were reported as which kind.
struct KindCounts {
  std::array<std::array<int, kAllKinds.size()>, kAllKinds.size()> rows{};  // [label's kind][reported kind]
  int of(ObjectKind label, ObjectKind reported) const {
    return rows[static_cast<std::size_t>(label)][static_cast<std::size_t>(reported)];
  }
  int total() const;
  double shareRight() const;  // 0 without rows
};

/// By whether the track had at least nine rows before.
struct KindErrors {
  KindCounts from_tenth_row, before;
};

/// Over the reported rows that were matched to labels which are asked for nearer than `to_m` and have a kind.
KindErrors kindErrors(const std::vector<ComparedFrame>& frames, double to_m);

}  // namespace motorcade
