#include "apps/check/epipolar_matching.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <span>

#include "frontend/image/image_pyramid.hpp"
#include "frontend/image/patch_alignment.hpp"
#include "frontend/image/window_differences.hpp"

namespace motorcade {
namespace {

constexpr int kLevel = 2;             // of the whole-pixel search: a quarter of full size
constexpr std::size_t kPoints = 200;  // per pair
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

/// The least cost that is not beside a place, or the greatest number.
int leastBesides(const RowCosts& costs, int count, Place best) {
  int least = UINT16_MAX;
  for (int r = 0; r < kSearchedRows; ++r)
    for (int i = 0; i < count; ++i)
      if (std::abs(r - best.v) > kBeside_px || std::abs(i - best.u) > kBeside_px)
        least = std::min<int>(least, costs[r][i]);
  return least;
}

/// Where another image looks most like the window, within some rows of it; empty when two places do.
std::optional<Place> searchArea(const Window& window, const Image& other, Columns columns) {
  const int half_columns = window.size.columns / 2, half_rows = window.size.rows / 2;
  columns.first = std::max(columns.first, half_columns);
  columns.last = std::min(columns.last, other.width() - 1 - half_columns);
  const int count = columns.last - columns.first + 1;
  if (count < 1) return std::nullopt;
  RowCosts costs;
  Place best;
  int least = UINT16_MAX;
  for (int r = 0; r < kSearchedRows; ++r) {
    const int v = window.v + r - kRows_px;
    const auto row = std::span(costs[r]).first(static_cast<std::size_t>(count));
    if (v < half_rows || v + half_rows >= other.height()) {
      std::ranges::fill(row, UINT16_MAX);
      continue;
    }
    windowDifferences(window, other, columns.first, v, row);
    const auto at = std::ranges::min_element(row);
    if (*at < least) least = *at, best = {static_cast<int>(at - row.begin()), r};
  }
  if (least > kMaxUniquenessRatio * leastBesides(costs, count, best)) return std::nullopt;
  return Place{columns.first + best.u, window.v + best.v - kRows_px};
}

/// The place in the right image at a quarter of the size, on which both directions of search agree.
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

}  // namespace

std::vector<EpipolarMatch> matchUnrectified(const ImagePyramid& left, const ImagePyramid& right,
                                            const std::vector<Corner>& corners) {
  std::vector<EpipolarMatch> matches;
  if (left.levels.size() <= kLevel || right.levels.size() <= kLevel) return matches;
  const std::size_t step = std::max<std::size_t>(1, corners.size() / kPoints);
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
