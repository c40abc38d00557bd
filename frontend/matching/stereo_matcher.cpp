#include "frontend/matching/stereo_matcher.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>

#include "frontend/features/sift_features.hpp"
#include "frontend/image/image_pyramid.hpp"
#include "frontend/image/window_differences.hpp"
#include "frontend/matching/half_occlusion.hpp"

namespace motorcade {
namespace {

using Costs = std::array<std::uint16_t, kMaxWindowCosts>;

std::uint16_t smallest(std::span<const std::uint16_t> costs) {
  std::uint16_t result = UINT16_MAX;
  for (const std::uint16_t cost : costs) result = std::min(result, cost);  // in vector code, which min_element is not
  return result;
}

/// Best window of a search; empty when another place, not a neighbor of the best, is nearly as good.
std::optional<int> uniqueMinimum(std::span<const std::uint16_t> costs, double max_ratio) {
  constexpr std::size_t kNeighbors_px = 2;
  const std::uint16_t least = smallest(costs);
  const auto best = static_cast<std::size_t>(std::ranges::find(costs, least) - costs.begin());
  const auto before = costs.first(best - std::min(best, kNeighbors_px));
  const auto after = costs.subspan(std::min(best + kNeighbors_px + 1, costs.size()));
  const bool alone = before.empty() && after.empty();
  if (!alone && least > max_ratio * std::min(smallest(before), smallest(after))) return std::nullopt;
  return static_cast<int>(best);
}

/// Column in `other`, between first_u and last_u, whose window looks most like the one at (u, v) of `image`.
std::optional<int> searchColumns(const Image& image, int u, int v, const Image& other, int first_u, int last_u,
                                 WindowSize window, double max_uniqueness_ratio) {
  const int half = window.columns / 2;
  first_u = std::max(first_u, half);
  last_u = std::min(last_u, other.width() - 1 - half);
  if (last_u < first_u) return std::nullopt;
  Costs costs;
  const auto searched = std::span(costs).first(static_cast<std::size_t>(last_u - first_u + 1));
  windowDifferences(image, u, v, other, first_u, v, window, searched);
  const auto best = uniqueMinimum(searched, max_uniqueness_ratio);
  if (!best) return std::nullopt;
  return first_u + *best;
}

bool holds(const Image& image, int u, int v, WindowSize window) {
  const int half_columns = window.columns / 2, half_rows = window.rows / 2;
  return v >= half_rows && v + half_rows < image.height() && u >= half_columns && u + half_columns < image.width();
}

/// Disparity to a whole pixel of the images given, agreed on from left to right and back.
std::optional<int> searchDisparity(const Image& left, const Image& right, int u, int v, int max_disparity_px,
                                   const StereoMatcher::Params& params) {
  const WindowSize window{params.search_columns, params.search_rows};
  if (!holds(left, u, v, window)) return std::nullopt;
  const auto u_right = searchColumns(left, u, v, right, u - max_disparity_px, u, window, params.max_uniqueness_ratio);
  if (!u_right) return std::nullopt;
  const auto u_back = searchColumns(right, *u_right, v, left, *u_right, *u_right + max_disparity_px, window,
                                    params.max_uniqueness_ratio);
  if (!u_back || std::abs(*u_back - u) > params.max_round_trip_px) return std::nullopt;
  return u - *u_right;
}

/// Disparity to a whole pixel of full size: searched in the images of half size, then among the pixels around.
std::optional<int> searchCoarseToFine(const Features& features, float u_px, float v_px,
                                      const StereoMatcher::Params& params) {
  const int u = static_cast<int>(u_px), v = static_cast<int>(v_px);
  const Image &left = features.left.levels.front(), &right = features.right.levels.front();
  if (features.left.levels.size() < 2) return searchDisparity(left, right, u, v, params.max_disparity_px, params);
  const auto half_size_px = searchDisparity(
      features.left.levels[1], features.right.levels[1], static_cast<int>(std::lround(toLevel(u_px, 1))),
      static_cast<int>(std::lround(toLevel(v_px, 1))), params.max_disparity_px / 2, params);
  constexpr WindowSize kWindow;
  if (!half_size_px || !holds(left, u, v, kWindow)) return std::nullopt;
  const int middle = u - 2 * *half_size_px;
  constexpr int kReach_px = 3;
  const auto u_right =
      searchColumns(left, u, v, right, middle - kReach_px, std::min(u, middle + kReach_px), kWindow, 1);
  if (!u_right) return std::nullopt;
  return u - *u_right;
}

std::vector<std::optional<StereoMatch>> matchCorners(const Features& features, const StereoMatcher::Params& params) {
  const Image &left = features.left.levels.front(), &right = features.right.levels.front();
  DisparityParams refinement = params.refinement;
  refinement.search_radius_px = 0;  // the search over all disparities has been here
  std::vector<std::optional<StereoMatch>> matches;
  matches.reserve(features.corners.size());
  for (const Corner& corner : features.corners) {
    auto& match = matches.emplace_back();
    const auto whole_px = searchCoarseToFine(features, corner.u_px, corner.v_px, params);
    if (whole_px) match = refineDisparity(left, right, corner.u_px, corner.v_px, *whole_px, refinement);
    if (match && match->disparity_px < params.min_disparity_px) match.reset();
  }
  return matches;
}

std::vector<std::optional<StereoMatch>> matchDescriptors(const Features& features,
                                                         const StereoMatcher::Params& params) {
  const SiftSearchRegion region{-static_cast<double>(params.max_disparity_px), -params.min_disparity_px,
                                params.sift_max_row_px};
  const auto match_of = matchSift(features.corners, features.descriptors, features.right_corners,
                                  features.right_descriptors, region, params.sift_max_ratio);
  std::vector<std::optional<StereoMatch>> matches(features.corners.size());
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (match_of[i] < 0) continue;
    const float disparity_px = features.corners[i].u_px - features.right_corners[match_of[i]].u_px;
    matches[i] = StereoMatch{disparity_px, static_cast<float>(params.sift_sigma_px)};
  }
  return matches;
}

}  // namespace

StereoMatcher::StereoMatcher(const Params& params) : params_(requireValid(params)) {
  if (params.search_columns % 2 == 0 || params.search_rows % 2 == 0)
    throw std::invalid_argument("stereo matcher: search_columns and search_rows must be odd");
  if (!fits({params.search_columns, params.search_rows}))
    throw std::invalid_argument("stereo matcher: search_columns must be at most " + std::to_string(kMaxWindowColumns) +
                                ", search_rows at most " + std::to_string(kMaxWindowRows) +
                                ", and their product at most " + std::to_string(kMaxWindowPixels));
}

StereoMatchesPtr StereoMatcher::operator()(const FeaturesPtr& features) const {
  StereoMatches matches{.features = features, .of_corner = {}};
  if (!features->frame->rejected())
    matches.of_corner =
        features->descriptors.empty() ? matchCorners(*features, params_) : matchDescriptors(*features, params_);
  dropHalfOccluded(features->corners, matches.of_corner);
  return std::make_shared<const StereoMatches>(std::move(matches));
}

std::vector<Parameter> parametersOf(StereoMatcher::Params& params) {
  return {numberParameter("min_disparity_px", params.min_disparity_px, {0.1, 5},
                          "lower keeps points that are farther away"),
          numberParameter("max_disparity_px", params.max_disparity_px, {16, kMaxWindowCosts - 12},
                          "higher finds points that are nearer, at more cost")};
}

}  // namespace motorcade
