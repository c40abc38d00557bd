#include "frontend/matching/stereo_matcher.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "frontend/features/sift_features.hpp"
#include "frontend/image/image_pyramid.hpp"
#include "frontend/image/patch_alignment.hpp"
#include "frontend/image/window_differences.hpp"
#include "frontend/matching/half_occlusion.hpp"

namespace motorcade {
namespace {

/// Greatest ratio of the least cost of a search to the least cost elsewhere: repeated texture lies above it.
constexpr double kMaxUniquenessRatio = 0.9;
constexpr int kMaxDisparity_px = 500;  // so that one search fits kMaxWindowCosts
constexpr int kMaxRoundTrip_px = 1;    // between the search from left to right and back, at half size
constexpr int kFineReach_px = 3;       // at full size around the result at half size, which is off by a pixel at most

// Greatest distance between the rows of two matching SIFT points, and greatest ratio of the nearest to the second
// nearest descriptor's distance.
constexpr double kSiftMaxRow_px = 1.5, kSiftMaxRatio = 0.9;

std::uint16_t smallest(std::span<const std::uint16_t> costs) {
  std::uint16_t result = UINT16_MAX;
  for (const std::uint16_t cost : costs)
    result = std::min(result, cost);  // compiles to vector code, unlike min_element
  return result;
}

/// Index of the least cost; empty when another one, not among its neighbors, is nearly as small.
std::optional<int> uniqueMinimum(std::span<const std::uint16_t> costs, double max_ratio) {
  constexpr std::size_t kNeighbors_px = 2;
  const std::uint16_t least = smallest(costs);
  const std::size_t best = std::ranges::find(costs, least) - costs.begin();
  const auto before = costs.first(best - std::min(best, kNeighbors_px));
  const auto after = costs.subspan(std::min(best + kNeighbors_px + 1, costs.size()));
  const bool alone = before.empty() && after.empty();
  if (!alone && least > max_ratio * std::min(smallest(before), smallest(after))) return std::nullopt;
  return static_cast<int>(best);
}

/// Column in `other`, between first_u and last_u, around which a window of the same row looks most like the one given.
std::optional<int> searchColumns(const Window& window, const Image& other, int first_u, int last_u, double max_ratio) {
  const int half = window.size.columns / 2;
  first_u = std::max(first_u, half);
  last_u = std::min(last_u, other.width() - 1 - half);
  if (last_u < first_u) return std::nullopt;
  std::array<std::uint16_t, kMaxWindowCosts> costs;
  const auto searched = std::span(costs).first(last_u - first_u + 1);
  windowDifferences(window, other, first_u, window.v, searched);
  const auto best = uniqueMinimum(searched, max_ratio);
  if (!best) return std::nullopt;
  return first_u + *best;
}

/// Disparity to a whole pixel of the images given, on which the searches from left to right and back agree.
std::optional<int> searchDisparity(const Image& left, const Image& right, int u, int v, int max_disparity_px) {
  const Window window{left, u, v, kHalfSizeWindow};
  if (!window.insideImage()) return std::nullopt;
  const auto u_right = searchColumns(window, right, u - max_disparity_px, u, kMaxUniquenessRatio);
  if (!u_right) return std::nullopt;
  const Window found{right, *u_right, v, kHalfSizeWindow};
  const auto u_back = searchColumns(found, left, *u_right, *u_right + max_disparity_px, kMaxUniquenessRatio);
  if (!u_back || std::abs(*u_back - u) > kMaxRoundTrip_px) return std::nullopt;
  return u - *u_right;
}

/// Disparity to a whole pixel of full size, searched in the images of half size, then among the pixels around.
std::optional<int> searchCoarseToFine(const Features& features, const Corner& corner, int max_disparity_px) {
  const int u = static_cast<int>(corner.u_px), v = static_cast<int>(corner.v_px);
  const Image &left = features.left.levels.front(), &right = features.right.levels.front();
  if (features.left.levels.size() < 2) return searchDisparity(left, right, u, v, max_disparity_px);
  const int half_u = static_cast<int>(std::lround(toLevel(corner.u_px, 1))),
            half_v = static_cast<int>(std::lround(toLevel(corner.v_px, 1)));
  const auto half_size_px =
      searchDisparity(features.left.levels[1], features.right.levels[1], half_u, half_v, max_disparity_px / 2);
  const Window window{left, u, v, kFullSizeWindow};
  if (!half_size_px || !window.insideImage()) return std::nullopt;
  const int middle = u - 2 * *half_size_px;
  constexpr double kAnyRatio = 1;  // uniqueness was checked at half size
  const auto u_right =
      searchColumns(window, right, middle - kFineReach_px, std::min(u, middle + kFineReach_px), kAnyRatio);
  if (!u_right) return std::nullopt;
  return u - *u_right;
}

std::vector<std::optional<StereoMatch>> matchCorners(const Features& features, const StereoMatcher::Params& params) {
  const Image &left = features.left.levels.front(), &right = features.right.levels.front();
  constexpr DisparityParams kOnlyRefinement{.search_radius_px = 0};
  std::vector<std::optional<StereoMatch>> matches;
  matches.reserve(features.corners.size());
  for (const Corner& corner : features.corners) {
    auto& match = matches.emplace_back();
    const auto whole_px = searchCoarseToFine(features, corner, params.max_disparity_px);
    if (whole_px) match = refineDisparity(left, right, corner.u_px, corner.v_px, *whole_px, kOnlyRefinement);
    if (match && match->disparity_px < params.min_disparity_px) match.reset();
  }
  return matches;
}

std::vector<std::optional<StereoMatch>> matchDescriptors(const Features& features,
                                                         const StereoMatcher::Params& params) {
  const SiftSearchRegion region{-static_cast<double>(params.max_disparity_px), -params.min_disparity_px,
                                kSiftMaxRow_px};
  const auto match_of = matchSift(features.corners, features.descriptors, features.right_corners,
                                  features.right_descriptors, region, kSiftMaxRatio);
  std::vector<std::optional<StereoMatch>> matches(features.corners.size());
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (match_of[i] < 0) continue;
    const float disparity_px = features.corners[i].u_px - features.right_corners[match_of[i]].u_px;
    matches[i] = StereoMatch{disparity_px, static_cast<float>(kSiftSigma_px)};
  }
  return matches;
}

}  // namespace

StereoMatcher::StereoMatcher(const Params& params) : params_(requireValid(params)) {}

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
          numberParameter("max_disparity_px", params.max_disparity_px, {16, kMaxDisparity_px},
                          "higher finds points that are nearer, at more cost")};
}

}  // namespace motorcade
