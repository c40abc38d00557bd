#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "core/instruction_set.hpp"
#include "frontend/image/window_differences.hpp"
#include "frontend/shape/dense_disparity.hpp"

#define HWY_TARGET_INCLUDE "frontend/shape/disparity_refinement.cpp"
#include <hwy/foreach_target.h>

#include "frontend/image/pixel_lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

constexpr WindowSize kSize = kHalfSizeWindow;
constexpr int kPixels = kSize.columns * kSize.rows;
constexpr int kReach_px = 2, kWindows = 2 * kReach_px + 1;
static_assert(kSize.columns + kWindows - 1 <= kWordLanes);

/// Ones at the columns of a window that lies so far to the right.
Words columnsAt(int first) {
  const Words column = wordNumbers() - allWords(first);
  return (column > allWords(-1)) & (column < allWords(kSize.columns)) & allWords(1);
}

/// Compares a window with a few of another image: what `windowDifferences` does for many at a time. The columns of a
/// window are lanes here, and the lanes beyond them are read, but do not count.
class NearDifferences {
 public:
  explicit NearDifferences(const Window& window) {
    for (int i = 0; i < kWindows; ++i) columns_[i] = columnsAt(i);
    Words columns{};
    for (int r = 0; r < kSize.rows; ++r) {
      rows_[r] = wordPixels(window.image.row(window.v - kSize.rows / 2 + r) + window.u - kSize.columns / 2);
      columns += rows_[r];
    }
    sum_ = total(products(columns, columns_[0]));
  }

  /// Of neighboring windows; the first pixel of the first is at `from`.
  std::array<int, kWindows> operator()(const std::uint8_t* from, std::ptrdiff_t stride) const {
    Words columns = wordPixels(from);
    for (int r = 1; r < kSize.rows; ++r) columns += wordPixels(from + r * stride);
    std::array<WordSums, kWindows> sums;
    for (int i = 0; i < kWindows; ++i) sums[i] = products(columns, columns_[i]);
    const std::array<int, kWindows> of_windows = totalsOf(sums);
    for (int i = 0; i < kWindows; ++i) sums[i] = sumOfMagnitudes(from + i, stride, of_windows[i] - sum_);
    return totalsOf(sums);
  }

 private:
  static std::array<int, kWindows> totalsOf(const std::array<WordSums, kWindows>& sums) {
    const FourSums four = totals(sums[0], sums[1], sums[2], sums[3]);
    return {four[0], four[1], four[2], four[3], total(sums[4])};
  }
  /// Of differences after their mean is taken out to a whole gray level; `sum`: of the differences.
  WordSums sumOfMagnitudes(const std::uint8_t* from, std::ptrdiff_t stride, int sum) const {
    const Words mean = allWords((sum * ((1 << 15) / kPixels) + (1 << 14)) >> 15);
    Words magnitudes{};
    for (int r = 0; r < kSize.rows; ++r) magnitudes += magnitude(wordPixels(from + r * stride) - (rows_[r] + mean));
    return products(magnitudes, columns_[0]);
  }

  std::array<Words, kWindows> columns_;
  std::array<Words, kSize.rows> rows_;
  int sum_ = 0;
};

/// Without branches: which window is best is unforeseeable.
int firstLeast(const std::array<int, kWindows>& costs) {
  constexpr int kNumbers = 8;
  static_assert(kWindows <= kNumbers);
  int least = costs[0] * kNumbers;
  for (int i = 1; i < kWindows; ++i) least = std::min(least, costs[i] * kNumbers + i);
  return least % kNumbers;
}

}  // namespace

void refineAll(const Image& left, const Image& right, int scale, std::span<const int> cells, DisparityMap& map) {
  constexpr int kHalf = kSize.columns / 2;
  for (const int cell : cells) {
    float& disparity_px = map.disparity_px[cell];
    if (disparity_px == DisparityMap::kNone) continue;
    const int u = (map.window.u0 + cell % map.window.width) * scale + scale / 2;
    const int v = (map.window.v0 + cell / map.window.width) * scale + scale / 2;
    const int first = u - static_cast<int>(std::floor(disparity_px * static_cast<float>(scale) + 0.5F)) - kReach_px;
    const Window window{left, u, v, kSize};
    if (!window.insideImage() || first < kHalf || first + 2 * kReach_px + kHalf >= right.width()) continue;
    const auto costs = NearDifferences(window)(right.row(v - kSize.rows / 2) + first - kHalf, right.stride());
    const int best = firstLeast(costs);
    if (best == 0 || best == 2 * kReach_px) continue;
    const float at = static_cast<float>(first + best) + parabolaOffset(costs[best - 1], costs[best], costs[best + 1]);
    disparity_px = (static_cast<float>(u) - at) / static_cast<float>(scale);
  }
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(refineAll);

void refineDisparities(const Image& left, const Image& right, int scale, std::span<const int> cells,
                       DisparityMap& map) {
  MOTORCADE_KERNEL(refineAll)(left, right, scale, cells, map);
}

}  // namespace motorcade
#endif
