#include "apps/watch/epipolar_matching.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>

#include "frontend/features/corner_detector.hpp"
#include "frontend/image/image_pyramid.hpp"
#include "frontend/image/patch_alignment.hpp"
#include "frontend/image/window_differences.hpp"

namespace motorcade {
namespace {

constexpr int kLevels = 4;
constexpr int kLevel = 2;        // of the whole-pixel search: a quarter of full size
constexpr int kCornerLevel = 1;  // of the corners: half of full size
// Of the search at a quarter of the size.
constexpr int kRows_px = 5, kLeastDisparity_px = -24, kMostDisparity_px = 48;
constexpr int kBeside_px = 2;  // of the best place, too near to compete with it
constexpr double kMaxUniquenessRatio = 0.85;
constexpr int kMaxRoundTrip_px = 1;

struct Place {
  int u = 0, v = 0;
};

/// A range of columns to search.
struct Columns {
  int first = 0, last = 0;
};

constexpr int kSearchedRows = 2 * kRows_px + 1;
using RowCosts = std::array<std::array<std::uint16_t, kMaxWindowCosts>, kSearchedRows>;

/// Finds the least cost without a branch, so that the compiler vectorizes the loop.
std::uint16_t leastOf(std::span<const std::uint16_t> costs) {
  std::uint16_t least = UINT16_MAX;
  for (const std::uint16_t cost : costs) least = std::min(least, cost);
  return least;
}

/// The least cost of positions that are not beside `best`, or the greatest number.
std::uint16_t leastBesides(const RowCosts& costs, int count, Place best) {
  const int before = std::max(0, best.u - kBeside_px), after = std::min(count, best.u + kBeside_px + 1);
  std::uint16_t least = UINT16_MAX;
  for (int r = 0; r < kSearchedRows; ++r) {
    const auto row = std::span(costs[r]).first(static_cast<std::size_t>(count));
    if (std::abs(r - best.v) > kBeside_px)
      least = std::min(least, leastOf(row));
    else
      least = std::min({least, leastOf(row.first(before)), leastOf(row.subspan(after))});
  }
  return least;
}

/// Finds the position in another image most like the window, within a few rows of it; empty if it is ambiguous.
std::optional<Place> searchArea(const Window& window, const Image& other, Columns columns) {
  const int half_columns = window.size.columns / 2, half_rows = window.size.rows / 2;
  columns.first = std::max(columns.first, half_columns);
  columns.last = std::min(columns.last, other.width() - 1 - half_columns);
  const int count = columns.last - columns.first + 1;
  if (count < 1) return std::nullopt;
  RowCosts costs;
  Place best;
  std::uint16_t least = UINT16_MAX;
  for (int r = 0; r < kSearchedRows; ++r) {
    const int v = window.v + r - kRows_px;
    const auto row = std::span(costs[r]).first(static_cast<std::size_t>(count));
    if (v < half_rows || v + half_rows >= other.height()) {
      std::ranges::fill(row, UINT16_MAX);
      continue;
    }
    windowDifferences(window, other, columns.first, v, row);
    const std::uint16_t least_of_row = leastOf(row);
    if (least_of_row >= least) continue;
    least = least_of_row;
    best = {static_cast<int>(std::ranges::find(row, least) - row.begin()), r};
  }
  if (least > kMaxUniquenessRatio * leastBesides(costs, count, best)) return std::nullopt;
  return Place{columns.first + best.u, window.v + best.v - kRows_px};
}

/// The position in the right image at a quarter of the size, on which both directions of search agree.
std::optional<Place> searchBothWays(const Image& left, const Image& right, Place from) {
  const Window window{left, from.u, from.v, kHalfSizeWindow};
  if (!window.insideImage()) return std::nullopt;
  const auto found = searchArea(window, right, {from.u - kMostDisparity_px, from.u - kLeastDisparity_px});
  if (!found) return std::nullopt;
  const Window back{right, found->u, found->v, kHalfSizeWindow};
  const auto again = searchArea(back, left, {found->u + kLeastDisparity_px, found->u + kMostDisparity_px});
  const bool same =
      again && std::abs(again->u - from.u) <= kMaxRoundTrip_px && std::abs(again->v - from.v) <= kMaxRoundTrip_px;
  return same ? found : std::nullopt;
}

struct Levels {
  double mean = 0, deviation = 0;  // gray levels
};

Levels levelsOf(const Image& image) {
  constexpr int kStep_px = 8;
  double count = 0, sum = 0, squares = 0;
  for (int y = kStep_px / 2; y < image.height(); y += kStep_px)
    for (int x = kStep_px / 2; x < image.width(); x += kStep_px) {
      const double gray = image.at(x, y);
      ++count, sum += gray, squares += gray * gray;
    }
  const double mean = sum / std::max(1.0, count);
  return {mean, std::sqrt(std::max(0.0, squares / std::max(1.0, count) - mean * mean))};
}

Image stretched(const Image& image, const Levels& from, const Levels& to, ImagePool& pool) {
  std::array<std::uint8_t, UINT8_MAX + 1> grays;
  for (std::size_t gray = 0; gray < grays.size(); ++gray) {
    const double level = to.mean + to.deviation / from.deviation * (static_cast<double>(gray) - from.mean);
    grays[gray] = static_cast<std::uint8_t>(std::clamp(std::lround(level), 0L, 255L));
  }
  Image result = pool.acquire(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y)
    std::transform(image.row(y), image.row(y) + image.width(), result.mutableRow(y),
                   [&](std::uint8_t gray) { return grays[gray]; });
  return result;
}

/// Gives the fainter image the contrast of the other if the two differ much, as windows are compared gray by gray.
void equalize(Image& left, Image& right, ImagePool& pool) {
  constexpr double kAlike = 1.5, kFaintest = 1;
  const Levels of_left = levelsOf(left), of_right = levelsOf(right);
  if (std::min(of_left.deviation, of_right.deviation) < kFaintest) return;
  if (of_left.deviation > kAlike * of_right.deviation) right = stretched(right, of_right, of_left, pool);
  if (of_right.deviation > kAlike * of_left.deviation) left = stretched(left, of_left, of_right, pool);
}

/// Detects corners, with a lower threshold where there are few, as in images that are dark or blurred.
std::vector<Corner> cornersOf(const Image& image) {
  constexpr std::size_t kFew = 60;
  constexpr double kFaintShare = 1.0 / 3;
  const CornerDetector detect({});
  auto corners = detect(image);
  return corners.size() < kFew ? detect(image, kFaintShare) : corners;
}

}  // namespace

PreparedPair preparePair(Image left, Image right, ImagePool& pool) {
  equalize(left, right, pool);
  PreparedPair pair{buildPyramid(left, kLevels, pool), buildPyramid(right, kLevels, pool), {}};
  if (pair.left.levels.size() <= kCornerLevel) return pair;
  pair.corners = cornersOf(pair.left.levels[kCornerLevel]);
  for (Corner& corner : pair.corners)
    corner = {fromLevel(corner.u_px, kCornerLevel), fromLevel(corner.v_px, kCornerLevel), corner.score};
  return pair;
}

std::vector<EpipolarMatch> matchUnrectified(const ImagePyramid& left, const ImagePyramid& right,
                                            const std::vector<Corner>& corners, std::size_t points) {
  std::vector<EpipolarMatch> matches;
  if (left.levels.size() <= kLevel || right.levels.size() <= kLevel) return matches;
  const std::size_t step = std::max<std::size_t>(1, (corners.size() + points - 1) / points);
  for (std::size_t i = 0; i < corners.size(); i += step) {
    const Corner& corner = corners[i];
    const Place from{static_cast<int>(std::lround(toLevel(corner.u_px, kLevel))),
                     static_cast<int>(std::lround(toLevel(corner.v_px, kLevel)))};
    const auto found = searchBothWays(left.levels[kLevel], right.levels[kLevel], from);
    if (!found) continue;
    // The corner does not lie on a pixel of the quarter: it keeps its distance from the one that was searched.
    const auto scale = static_cast<float>(1 << kLevel);
    const Eigen::Vector2f guess(corner.u_px + scale * static_cast<float>(found->u - from.u),
                                corner.v_px + scale * static_cast<float>(found->v - from.v));
    const auto aligned = alignPatch(left, {corner.u_px, corner.v_px}, right, guess, kLevel, {});
    if (aligned) matches.push_back({corner.u_px, corner.v_px, aligned->u_px, aligned->v_px});
  }
  return matches;
}

}  // namespace motorcade
