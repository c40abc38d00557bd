#include "frontend/matching/stereo_matcher.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <utility>

#include "frontend/features/sift_features.hpp"
#include "frontend/image/detail_search.hpp"
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
constexpr double kSiftMaxRow_px = 1.5, kSiftMaxStereoRatio = 0.9;

/// The pair in which all disparities are searched: of half size, or of full size where there is no other.
struct SearchedPair {
  int level;
  DetailedImage left, right;
};

SearchedPair searchedPair(const Features& features, ImagePool& pool) {
  const int level = features.left.levels.size() < 2 ? 0 : 1;
  return {level, withDetail(features.left.levels[level], pool), withDetail(features.right.levels[level], pool)};
}

/// Disparity to a whole pixel of the pair, on which the searches from left to right and back agree.
std::optional<int> searchDisparity(const SearchedPair& pair, int u, int v, int max_disparity_px) {
  if (!Window{pair.left.image, u, v, kHalfSizeWindow}.insideImage()) return std::nullopt;
  const auto u_right = searchRow(pair.left, u, v, pair.right, {u - max_disparity_px, u}, kMaxUniquenessRatio);
  if (!u_right) return std::nullopt;
  const auto u_back =
      searchRow(pair.right, *u_right, v, pair.left, {*u_right, *u_right + max_disparity_px}, kMaxUniquenessRatio);
  if (!u_back || std::abs(*u_back - u) > kMaxRoundTrip_px) return std::nullopt;
  return u - *u_right;
}

/// Column of the right image at full size, around the one given, whose window looks most like the left one.
std::optional<int> searchNear(const Window& window, const Image& right, int middle_u) {
  constexpr int kHalf_px = kFullSizeWindow.columns / 2;
  const int first_u = std::max(middle_u - kFineReach_px, kHalf_px);
  const int last_u = std::min({window.u, middle_u + kFineReach_px, right.width() - 1 - kHalf_px});
  if (last_u < first_u) return std::nullopt;
  std::array<std::uint16_t, 2 * kFineReach_px + 1> costs;
  const auto searched = std::span(costs).first(last_u - first_u + 1);
  windowDifferences(window, right, first_u, window.v, searched);
  return first_u + static_cast<int>(std::ranges::min_element(searched) - searched.begin());
}

/// Disparity to a whole pixel of full size, searched in the images of half size, then among the pixels around.
std::optional<int> searchCoarseToFine(const Features& features, const SearchedPair& pair, const Corner& corner,
                                      int max_disparity_px) {
  const int u = static_cast<int>(corner.u_px), v = static_cast<int>(corner.v_px);
  if (pair.level == 0) return searchDisparity(pair, u, v, max_disparity_px);
  const int half_u = static_cast<int>(std::lround(toLevel(corner.u_px, 1))),
            half_v = static_cast<int>(std::lround(toLevel(corner.v_px, 1)));
  const auto half_size_px = searchDisparity(pair, half_u, half_v, max_disparity_px / 2);
  const Window window{features.left.levels.front(), u, v, kFullSizeWindow};
  if (!half_size_px || !window.insideImage()) return std::nullopt;
  const auto u_right = searchNear(window, features.right.levels.front(), u - 2 * *half_size_px);
  if (!u_right) return std::nullopt;
  return u - *u_right;
}

std::vector<std::optional<StereoMatch>> matchCorners(const Features& features, const StereoMatcher::Params& params,
                                                     ImagePool& pool) {
  const SearchedPair pair = searchedPair(features, pool);
  std::vector<std::optional<StereoMatch>> matches;
  matches.reserve(features.corners.size());
  for (const Corner& corner : features.corners) {
    auto& match = matches.emplace_back();
    const auto whole_px = searchCoarseToFine(features, pair, corner, params.max_disparity_px);
    if (whole_px) match = StereoMatch{.disparity_px = static_cast<float>(*whole_px)};
  }
  return matches;
}

std::vector<std::optional<StereoMatch>> matchDescriptors(const Features& features,
                                                         const StereoMatcher::Params& params) {
  const SiftSearchRegion region{-static_cast<double>(params.max_disparity_px), -params.min_disparity_px,
                                kSiftMaxRow_px};
  const auto match_of = matchSift(features.corners, features.descriptors, features.right_corners,
                                  features.right_descriptors, region, kSiftMaxStereoRatio);
  std::vector<std::optional<StereoMatch>> matches(features.corners.size());
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (match_of[i] < 0) continue;
    const float disparity_px = features.corners[i].u_px - features.right_corners[match_of[i]].u_px;
    matches[i] = StereoMatch{disparity_px, static_cast<float>(kSiftSigma_px)};
  }
  return matches;
}

/// Drops half-occluded points; the corners that decide on them are refined at once.
void dropHalfOccluded(StereoMatches& matches) {
  const auto& corners = matches.features->corners;
  const float greatest_px = greatestDisparity_px(matches.of_corner);
  for (std::size_t i = 0; i < matches.of_corner.size(); ++i)
    if (decidesHalfOcclusion(corners[i], greatest_px)) matches.of_corner[i] = refinedMatch(matches, i);
  dropHalfOccluded(corners, matches.of_corner);
}

}  // namespace

StereoMatcher::StereoMatcher(const Params& params) : params_(requireValid(params)) {}

StereoMatchesPtr StereoMatcher::operator()(const FeaturesPtr& features) const {
  StereoMatches matches{.features = features, .of_corner = {}, .min_disparity_px = params_.min_disparity_px};
  if (!features->frame->rejected())
    matches.of_corner =
        features->descriptors.empty() ? matchCorners(*features, params_, pool_) : matchDescriptors(*features, params_);
  dropHalfOccluded(matches);
  return std::make_shared<const StereoMatches>(std::move(matches));
}

std::optional<StereoMatch> refinedMatch(const StereoMatches& matches, std::size_t corner) {
  auto match = matches.of_corner[corner];
  if (!match || match->sigma_px > 0) return match;
  const Features& features = *matches.features;
  const Corner& at = features.corners[corner];
  constexpr DisparityParams kOnlyRefinement{.search_radius_px = 0};
  match = refineDisparity(features.left.levels.front(), features.right.levels.front(), at.u_px, at.v_px,
                          match->disparity_px, kOnlyRefinement);
  if (match && match->disparity_px < matches.min_disparity_px) match.reset();
  return match;
}

std::vector<Parameter> parametersOf(StereoMatcher::Params& params) {
  return {numberParameter("min_disparity_px", params.min_disparity_px, {0.1, 5},
                          "lower keeps points that are farther away"),
          numberParameter("max_disparity_px", params.max_disparity_px, {16, kMaxDisparity_px},
                          "higher finds points that are nearer, at more cost")};
}

}  // namespace motorcade
