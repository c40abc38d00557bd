#include "frontend/shape/dense_disparity.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <span>

#include "frontend/image/window_differences.hpp"

namespace motorcade {
namespace {

constexpr int kCensusHalf_px = 2, kCensusSide = 2 * kCensusHalf_px + 1;  // 5x5 pixels, 24 comparisons
constexpr std::uint8_t kUnknownCost = 12;  // of a pixel without counterpart: as of one picked at random
constexpr std::uint16_t kStep = 5;         // penalty for a change of the disparity by one, along a path
constexpr std::uint16_t kJump = 22;        // and for a greater one
constexpr std::uint16_t kFar = 20'000;     // of a path: more than any sum of costs, and far from an overflow
constexpr int kMaxRoundTrip_px = 1;
constexpr int kLeastTexture = 10;  // gray levels between the brightest and the darkest of a 5x5 window

/// Which pixels of a 5x5 window are darker than its middle. The rows are those of the window; columns are clamped.
template <bool kInside>
std::uint32_t censusAt(const std::array<const std::uint8_t*, kCensusSide>& rows, int u, int width) {
  const std::uint8_t middle = rows[kCensusHalf_px][u];
  std::uint32_t bits = 0;
  for (const std::uint8_t* row : rows)
    for (int dx = -kCensusHalf_px; dx <= kCensusHalf_px; ++dx) {
      const int column = kInside ? u + dx : std::clamp(u + dx, 0, width - 1);
      bits = bits << 1 | (row[column] < middle ? 1U : 0U);
    }
  return bits;
}

/// Brightest minus darkest of every other pixel around: without texture, a disparity is but its neighbors'.
int textureAt(const Image& image, int u, int v) {
  int least = 255, most = 0;
  for (int y = std::max(v - kCensusHalf_px, 0); y <= std::min(v + kCensusHalf_px, image.height() - 1); y += 2)
    for (int x = std::max(u - kCensusHalf_px, 0); x <= std::min(u + kCensusHalf_px, image.width() - 1); x += 2) {
      const int gray = image.row(y)[x];
      least = std::min(least, gray), most = std::max(most, gray);
    }
  return most - least;
}

void fillCensus(const Image& image, const PixelWindow& window, std::vector<std::uint32_t>& census) {
  census.resize(static_cast<std::size_t>(window.area()));
  std::size_t at = 0;
  for (int row = 0; row < window.height; ++row) {
    std::array<const std::uint8_t*, kCensusSide> rows;
    for (int i = 0; i < kCensusSide; ++i)
      rows[i] = image.row(std::clamp(window.v0 + row + i - kCensusHalf_px, 0, image.height() - 1));
    for (int u = window.u0; u < window.u0 + window.width; ++u) {
      const bool inside = u >= kCensusHalf_px && u + kCensusHalf_px < image.width();
      census[at++] = inside ? censusAt<true>(rows, u, image.width()) : censusAt<false>(rows, u, image.width());
    }
  }
}

/// One step along a path: the cost of each disparity with the cheapest way to get there from the pixel before. A path
/// has a value of kFar before its first and after its last.
void stepAlongPath(const std::uint8_t* costs, std::uint16_t* path, std::uint16_t* next, std::uint16_t* sums,
                   std::size_t count) {
  std::uint16_t least = kFar;
  for (std::size_t i = 1; i <= count; ++i) least = std::min(least, path[i]);
  const auto jump = static_cast<std::uint16_t>(least + kJump);
  for (std::size_t i = 1; i <= count; ++i) {
    const std::uint16_t step = std::min(path[i - 1], path[i + 1]) + kStep;
    const std::uint16_t way = std::min(std::min(path[i], step), jump);
    next[i] = static_cast<std::uint16_t>(costs[i - 1] + way - least);
    sums[i - 1] = static_cast<std::uint16_t>(sums[i - 1] + next[i]);
  }
}

/// Of a parabola through three neighboring values, the place of its least, in -1/2 ... 1/2.
float parabolaOffset(int before, int least, int after) {
  const int curvature = before + after - 2 * least;
  return curvature > 0 ? 0.5F * static_cast<float>(before - after) / static_cast<float>(curvature) : 0.0F;
}

}  // namespace

DisparityMap DenseDisparity::operator()(const Image& left, const Image& right, PixelWindow window, Range range) {
  const int u_end = std::min(window.u0 + window.width, left.width()),
            v_end = std::min(window.v0 + window.height, left.height());
  window.u0 = std::max(window.u0, 0), window.v0 = std::max(window.v0, 0);
  window.width = u_end - window.u0, window.height = v_end - window.v0;
  range.count += std::min(range.least_px, 0);
  range.least_px = std::max(range.least_px, 0);
  DisparityMap map{.window = window, .disparity_px = {}};
  if (window.empty() || range.count <= 0) return {};
  map.disparity_px.assign(static_cast<std::size_t>(window.area()), DisparityMap::kNone);

  right_u0_ = std::max(0, window.u0 - range.least_px - range.count + 1);
  right_width_ = std::min(u_end - range.least_px, right.width()) - right_u0_;
  if (right_width_ <= 0) return map;
  fillCensus(left, window, left_);
  fillCensus(right, {right_u0_, window.v0, right_width_, window.height}, right_);
  fillCosts(window, range);
  aggregate(window, range);
  choose(left, map, range);
  return map;
}

void DenseDisparity::fillCosts(const PixelWindow& window, const Range& range) {
  costs_.assign(static_cast<std::size_t>(window.area()) * range.count, kUnknownCost);
  std::size_t pixel = 0;
  for (int row = 0; row < window.height; ++row) {
    const std::uint32_t* right = right_.data() + static_cast<std::ptrdiff_t>(row) * right_width_;
    for (int column = 0; column < window.width; ++column, ++pixel) {
      const std::uint32_t census = left_[pixel];
      std::uint8_t* costs = costs_.data() + pixel * range.count;
      const int at = window.u0 + column - range.least_px - right_u0_;  // in `right`, at the least disparity
      const int first = std::max(0, at - right_width_ + 1), end = std::min(range.count, at + 1);
      for (int i = first; i < end; ++i) costs[i] = static_cast<std::uint8_t>(std::popcount(census ^ right[at - i]));
    }
  }
}

void DenseDisparity::aggregate(const PixelWindow& window, const Range& range) {
  sums_.assign(costs_.size(), 0);
  for (int row = 0; row < window.height; ++row) {
    sumAlongRow(window, range, row, false);
    sumAlongRow(window, range, row, true);
  }
  sumAlongColumns(window, range, false);
  sumAlongColumns(window, range, true);
}

void DenseDisparity::sumAlongRow(const PixelWindow& window, const Range& range, int row, bool backward) {
  const std::size_t n = range.count;
  beginPaths(1, n);
  for (int i = 0; i < window.width; ++i) {
    const int column = backward ? window.width - 1 - i : i;
    const std::size_t at = (static_cast<std::size_t>(row) * window.width + column) * n;
    stepAlongPath(costs_.data() + at, path_.data(), next_.data(), sums_.data() + at, n);
    path_.swap(next_);
  }
}

/// Row by row, with one path per column.
void DenseDisparity::sumAlongColumns(const PixelWindow& window, const Range& range, bool backward) {
  const std::size_t n = range.count;
  beginPaths(window.width, n);
  for (int i = 0; i < window.height; ++i) {
    const int row = backward ? window.height - 1 - i : i;
    for (int column = 0; column < window.width; ++column) {
      const std::size_t at = (static_cast<std::size_t>(row) * window.width + column) * n, path = column * (n + 2);
      stepAlongPath(costs_.data() + at, path_.data() + path, next_.data() + path, sums_.data() + at, n);
    }
    path_.swap(next_);
  }
}

void DenseDisparity::beginPaths(std::size_t paths, std::size_t count) {
  path_.assign(paths * (count + 2), 0);
  for (std::size_t i = 0; i < paths; ++i) path_[i * (count + 2)] = path_[(i + 1) * (count + 2) - 1] = kFar;
  next_ = path_;
}

/// Of each row, the disparity of each column of the right image that has the least sum.
void DenseDisparity::chooseOfRight(const PixelWindow& window, const Range& range, int row) {
  best_of_right_.assign(right_width_, -1);
  least_of_right_.assign(right_width_, UINT16_MAX);
  const std::uint16_t* sums = sums_.data() + static_cast<std::size_t>(row) * window.width * range.count;
  for (int column = 0; column < window.width; ++column, sums += range.count) {
    const int at = window.u0 + column - range.least_px - right_u0_;
    const int first = std::max(0, at - right_width_ + 1), end = std::min(range.count, at + 1);
    for (int i = first; i < end; ++i)
      if (sums[i] < least_of_right_[at - i]) least_of_right_[at - i] = sums[i], best_of_right_[at - i] = i;
  }
}

void DenseDisparity::choose(const Image& left, DisparityMap& map, const Range& range) {
  const PixelWindow& window = map.window;
  const std::size_t n = range.count;
  for (int row = 0; row < window.height; ++row) {
    chooseOfRight(window, range, row);
    for (int column = 0; column < window.width; ++column) {
      const std::size_t pixel = static_cast<std::size_t>(row) * window.width + column;
      const std::span<const std::uint16_t> sums(sums_.data() + pixel * n, n);
      std::uint16_t least = UINT16_MAX;
      for (const std::uint16_t sum : sums) least = std::min(least, sum);
      const auto best = static_cast<int>(std::ranges::find(sums, least) - sums.begin());
      const int at = window.u0 + column - range.least_px - best - right_u0_;
      if (at < 0 || at >= right_width_ || std::abs(best_of_right_[at] - best) > kMaxRoundTrip_px) continue;
      if (textureAt(left, window.u0 + column, window.v0 + row) < kLeastTexture) continue;
      const bool inside = best > 0 && best + 1 < range.count;
      const float offset = inside ? parabolaOffset(sums[best - 1], sums[best], sums[best + 1]) : 0.0F;
      map.disparity_px[pixel] = static_cast<float>(range.least_px + best) + offset;
    }
  }
}

void refineDisparities(const Image& left, const Image& right, int scale, DisparityMap& map) {
  constexpr int kReach_px = 2;
  std::array<std::uint16_t, 2 * kReach_px + 1> costs;
  for (int row = 0; row < map.window.height; ++row) {
    for (int column = 0; column < map.window.width; ++column) {
      float& disparity_px = map.disparity_px[static_cast<std::size_t>(row) * map.window.width + column];
      if (disparity_px == DisparityMap::kNone) continue;
      const int u = (map.window.u0 + column) * scale + scale / 2, v = (map.window.v0 + row) * scale + scale / 2;
      const int first = u - static_cast<int>(std::lround(disparity_px * static_cast<float>(scale))) - kReach_px;
      const Window window{left, u, v, kHalfSizeWindow};
      const int half = kHalfSizeWindow.columns / 2;
      if (!window.insideImage() || first < half || first + 2 * kReach_px + half >= right.width()) continue;
      windowDifferences(window, right, first, v, costs);
      const auto best = static_cast<int>(std::ranges::min_element(costs) - costs.begin());
      if (best == 0 || best == 2 * kReach_px) continue;
      const float at = static_cast<float>(first + best) + parabolaOffset(costs[best - 1], costs[best], costs[best + 1]);
      disparity_px = (static_cast<float>(u) - at) / static_cast<float>(scale);
    }
  }
}

}  // namespace motorcade
