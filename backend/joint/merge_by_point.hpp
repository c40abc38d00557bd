#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/messages.hpp"

namespace motorcade {

/// Walks through known points and measurements of some of them, both ordered by point. Calls `seen(measurement,
/// known)`, with null for a new point, and `unseen(known)`, in that order. `point_of` returns an item's point.
template <class Item, class PointOf, class Seen, class Unseen>
void mergeByPoint(std::vector<Item>& known, std::span<const PointMeasurement> measurements, const PointOf& point_of,
                  const Seen& seen, const Unseen& unseen) {
  auto next = known.begin();
  const auto passUpTo = [&](PointId point) {
    for (; next != known.end() && point_of(*next) < point; ++next) unseen(*next);
  };
  for (const PointMeasurement& m : measurements) {
    passUpTo(m.point);
    const bool is_known = next != known.end() && point_of(*next) == m.point;
    seen(m, is_known ? &*next++ : nullptr);
  }
  passUpTo({std::numeric_limits<std::int64_t>::max()});
}

}  // namespace motorcade
