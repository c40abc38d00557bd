#include "frontend/shape/disparity_refinement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "frontend/image/window_differences.hpp"
#include "frontend/image/word_lanes.hpp"
#include "frontend/shape/parabola.hpp"

namespace motorcade {
namespace {

constexpr WindowSize kSize = kHalfSizeWindow;
constexpr int kPixels = kSize.columns * kSize.rows;
constexpr int kReach_px = 2, kWindows = 2 * kReach_px + 1;
static_assert(kSize.columns <= kWordLanes);

Words maskOfColumns() {
  Words mask{};
  for (int i = 0; i < kSize.columns; ++i) mask[i] = -1;
  return mask;
}

/// Compares a window with a few of another image: what `windowDifferences` does for many at a time. The columns of a
/// window are lanes here, and the lanes beyond them are read, but do not count.
class NearDifferences {
 public:
  explicit NearDifferences(const Window& window) : mask_(maskOfColumns()) {
    for (int r = 0; r < kSize.rows; ++r)
      rows_[r] = wordPixels(window.image.row(window.v - kSize.rows / 2 + r) + window.u - kSize.columns / 2);
  }

  /// Of neighboring windows; the first pixel of the first is at `from`.
  std::array<int, kWindows> operator()(const std::uint8_t* from, std::ptrdiff_t stride) const {
    std::array<Rows, kWindows> differences;
    std::array<WordSums, kWindows> sums;
    for (int i = 0; i < kWindows; ++i) sums[i] = sumOf(differences[i] = rowsOf(from + i, stride));
    const std::array<int, kWindows> means = totalsOf(sums);
    for (int i = 0; i < kWindows; ++i) sums[i] = sumOfMagnitudes(differences[i], means[i]);
    return totalsOf(sums);
  }

 private:
  using Rows = std::array<Words, kSize.rows>;
  Rows rowsOf(const std::uint8_t* from, std::ptrdiff_t stride) const {
    Rows rows;
    for (int r = 0; r < kSize.rows; ++r) rows[r] = wordPixels(from + r * stride) - rows_[r];
    return rows;
  }
  static std::array<int, kWindows> totalsOf(const std::array<WordSums, kWindows>& sums) {
    const auto [a, b, c, d] = totals(sums[0], sums[1], sums[2], sums[3]);
    return {a, b, c, d, totals(sums[4], sums[4], sums[4], sums[4])[0]};
  }
  WordSums sumOf(const Rows& rows) const {
    Words sum = rows[0];
    for (int r = 1; r < kSize.rows; ++r) sum += rows[r];
    return products(sum & mask_, allWords(1));
  }
  /// After their mean, of `sum`, is taken out to a whole gray level.
  WordSums sumOfMagnitudes(const Rows& rows, int sum) const {
    const Words mean = allWords((sum * ((1 << 15) / kPixels) + (1 << 14)) >> 15);
    Words magnitudes = magnitude(rows[0] - mean);
    for (int r = 1; r < kSize.rows; ++r) magnitudes += magnitude(rows[r] - mean);
    return products(magnitudes & mask_, allWords(1));
  }

  Words mask_;
  Rows rows_;
};

}  // namespace

void refineDisparities(const Image& left, const Image& right, int scale, std::span<const int> cells,
                       DisparityMap& map) {
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
    const auto best = static_cast<int>(std::ranges::min_element(costs) - costs.begin());
    if (best == 0 || best == 2 * kReach_px) continue;
    const float at = static_cast<float>(first + best) + parabolaOffset(costs[best - 1], costs[best], costs[best + 1]);
    disparity_px = (static_cast<float>(u) - at) / static_cast<float>(scale);
  }
}

}  // namespace motorcade
