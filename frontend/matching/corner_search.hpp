#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "frontend/matching/corner_lookup.hpp"

namespace motorcade {

/// A search among corners for the two that look most like a point.
struct CornerSearch {
  // Of each corner, as the grid has them: its place, look and number.
  const float *us_px = nullptr, *vs_px = nullptr;
  const Signature* signatures = nullptr;
  const int* corners = nullptr;
  const Signature* look = nullptr;
  std::array<int, 256> within;  // places of corners to be compared
  std::size_t count = 0;
  std::int64_t first = 0, second = 0;  // keys

  /// Key that is least for the most similar corner, and for the first of those that look alike.
  static std::int64_t key(int difference, int corner) { return std::int64_t{difference} << 32 | corner; }
};

}  // namespace motorcade
