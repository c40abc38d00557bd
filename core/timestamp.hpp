#pragma once

#include <compare>
#include <cstdint>

namespace motorcade {

/// A moment of the capture clock, in integer nanoseconds.
struct Timestamp {
  std::int64_t ns = 0;
  constexpr auto operator<=>(const Timestamp&) const = default;
};

/// Seconds from `from` to `to`.
constexpr double secondsBetween(Timestamp from, Timestamp to) { return static_cast<double>(to.ns - from.ns) * 1e-9; }

}  // namespace motorcade
