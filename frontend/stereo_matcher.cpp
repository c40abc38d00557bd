#include "frontend/stereo_matcher.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>

#include "frontend/sift_features.hpp"

namespace motorcade {
namespace {

using Costs = std::array<std::uint16_t, kMaxWindowCosts>;

/// Best window of a search; empty when another place, not a neighbour of the best, is nearly as good.
std::optional<int> uniqueMinimum(std::span<const std::uint16_t> costs, double max_ratio) {
  const int best = static_cast<int>(std::ranges::min_element(costs) - costs.begin());
  constexpr int kNeighbours_px = 2;
  int elsewhere = INT32_MAX;
  for (int i = 0; i < static_cast<int>(costs.size()); ++i)
    if (std::abs(i - best) > kNeighbours_px) elsewhere = std::min<int>(elsewhere, costs[static_cast<std::size_t>(i)]);
  if (costs[static_cast<std::size_t>(best)] > max_ratio * elsewhere) return std::nullopt;
  return best;
}

/// Column in `other`, between first_u and last_u, whose window looks most like the one at (u, v) of `image`.
std::optional<int> searchColumns(const Image& image, int u, int v, const Image& other, int first_u, int last_u,
                                 const StereoMatcher::Params& params) {
  const int half = params.search_columns / 2;
  first_u = std::max(first_u, half);
  last_u = std::min(last_u, other.width() - 1 - half);
  if (last_u < first_u) return std::nullopt;
  Costs costs;
  const int places = last_u - first_u + 1;
  const auto searched = std::span(costs).first(static_cast<std::size_t>(places));
  windowDifferences(image, u, v, other, first_u, v, {params.search_columns, params.search_rows}, searched);
  const auto best = uniqueMinimum(searched, params.max_uniqueness_ratio);
  if (!best) return std::nullopt;
  return first_u + *best;
}

/// Disparity to a whole pixel, agreed on from left to right and back.
std::optional<int> searchDisparity(const Image& left, const Image& right, int u, int v, const StereoMatcher::Params& params) {
  const int half_columns = params.search_columns / 2, half_rows = params.search_rows / 2;
  if (v < half_rows || v + half_rows >= left.height() || u < half_columns || u + half_columns >= left.width()) return std::nullopt;
  const auto u_right = searchColumns(left, u, v, right, u - params.max_disparity_px, u, params);
  if (!u_right) return std::nullopt;
  const auto u_back = searchColumns(right, *u_right, v, left, *u_right, *u_right + params.max_disparity_px, params);
  if (!u_back || std::abs(*u_back - u) > params.max_round_trip_px) return std::nullopt;
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
    const auto whole_px = searchDisparity(left, right, static_cast<int>(corner.u_px), static_cast<int>(corner.v_px), params);
    if (whole_px) match = refineDisparity(left, right, corner.u_px, corner.v_px, *whole_px, refinement);
    if (match && match->disparity_px < params.min_disparity_px) match.reset();
  }
  return matches;
}

std::vector<std::optional<StereoMatch>> matchDescriptors(const Features& features, const StereoMatcher::Params& params) {
  const SiftSearchRegion region{-static_cast<double>(params.max_disparity_px), -params.min_disparity_px, params.sift_max_row_px};
  const auto match_of =
      matchSift(features.corners, features.descriptors, features.right_corners, features.right_descriptors, region, params.sift_max_ratio);
  std::vector<std::optional<StereoMatch>> matches(features.corners.size());
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (match_of[i] < 0) continue;
    const float disparity_px = features.corners[i].u_px - features.right_corners[static_cast<std::size_t>(match_of[i])].u_px;
    matches[i] = StereoMatch{disparity_px, static_cast<float>(params.sift_sigma_px)};
  }
  return matches;
}

}  // namespace

StereoMatcher::StereoMatcher(const Params& params, const StereoCamera&) : params_(params) {
  if (params.max_disparity_px < 1 || params.max_disparity_px >= kMaxWindowCosts)
    throw std::invalid_argument("stereo matcher: max_disparity_px must be between 1 and " + std::to_string(kMaxWindowCosts - 1));
  if (params.search_columns % 2 == 0 || params.search_rows % 2 == 0)
    throw std::invalid_argument("stereo matcher: search_columns and search_rows must be odd");
  if (!fits({params.search_columns, params.search_rows}))
    throw std::invalid_argument("stereo matcher: search_columns must be at most " + std::to_string(kMaxWindowColumns) + ", search_rows at most " +
                                std::to_string(kMaxWindowRows) + ", and their product at most " + std::to_string(kMaxWindowPixels));
}

StereoMatchesPtr StereoMatcher::operator()(const FeaturesPtr& features) const {
  StereoMatches matches{.features = features, .of_corner = {}};
  if (!features->frame->rejected())
    matches.of_corner = features->descriptors.empty() ? matchCorners(*features, params_) : matchDescriptors(*features, params_);
  return std::make_shared<const StereoMatches>(std::move(matches));
}

}  // namespace motorcade
