#include "io/images/png_filters.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdlib>
#include <cstring>

namespace motorcade {
namespace {

/// The filters of the PNG specification (2nd edition, section 9.2), with its numbers.
enum Filter { kNone, kSub, kUp, kAverage, kPaeth };

/// Returns the one of three neighbors that is closest to left + above - corner (section 9.4). It has no branches, as
/// noise would make them unpredictable.
int paeth(int left, int above, int corner) {
  const int right = left - corner, down = above - corner;
  const int from_left = std::abs(down), from_above = std::abs(right), from_corner = std::abs(right + down);
  const int side = from_left <= from_above ? left : above;
  return std::min(from_left, from_above) <= from_corner ? side : corner;
}

/// Adds the result of `predict(left, above, corner)`. The row comes by value, so that the compiler knows that writing
/// does not change its pointers.
template <int kChannels, class Predict>
void addPrediction(FilteredRow row, std::uint8_t* to, const Predict& predict) {
  std::array<std::uint8_t, kChannels> left{}, corner{};
  for (std::size_t x = 0; x < row.count; x += kChannels) {
    for (std::size_t c = 0; c < kChannels; ++c) {
      const std::uint8_t above = row.above[x + c];
      left[c] = static_cast<std::uint8_t>(row.bytes[x + c] + predict(left[c], above, corner[c]));
      corner[c] = above;
      to[x + c] = left[c];
    }
  }
}

void addRowAbove(FilteredRow row, std::uint8_t* to) {
  for (std::size_t x = 0; x < row.count; ++x) to[x] = static_cast<std::uint8_t>(row.bytes[x] + row.above[x]);
}

template <int kChannels>
bool removeFilterOf(int filter, FilteredRow row, std::uint8_t* to) {
  switch (filter) {
    case kNone:
      std::memmove(to, row.bytes, row.count);
      return true;
    case kSub:
      addPrediction<kChannels>(row, to, [](int left, int, int) { return left; });
      return true;
    case kUp:
      addRowAbove(row, to);
      return true;
    case kAverage:
      addPrediction<kChannels>(row, to, [](int left, int above, int) { return (left + above) >> 1; });
      return true;
    case kPaeth:
      addPrediction<kChannels>(row, to, paeth);
      return true;
    default:
      return false;
  }
}

}  // namespace

bool removeFilter(int filter, int pixel_bytes, FilteredRow row, std::uint8_t* to) {
  switch (pixel_bytes) {
    case 1:
      return removeFilterOf<1>(filter, row, to);
    case 2:
      return removeFilterOf<2>(filter, row, to);
    case 3:
      return removeFilterOf<3>(filter, row, to);
    case 4:
      return removeFilterOf<4>(filter, row, to);
    default:
      assert(false);
      return false;
  }
}

}  // namespace motorcade
