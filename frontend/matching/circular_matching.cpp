#include "frontend/matching/circular_matching.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "frontend/image/patch_alignment.hpp"
#include "frontend/matching/stereo_matcher.hpp"
#include "frontend/parallel_items.hpp"

namespace motorcade {
namespace {

constexpr float kNeighbor_px = 10;  // corners this near mostly lie on the same surface and have a similar disparity
/// Extra search while the camera's motion is unknown, as a share of the last disparity. The disparity of a point 10 m
/// ahead grows so much from frame to frame at 13 m/s and ten frames a second.
constexpr double kUnknownMotionSearch = 0.15;

std::optional<StereoMatch> refineAround(const Features& features, const FlowObservation& point, double disparity_px,
                                        const DisparityParams& search) {
  return refineDisparity(features.left.levels.front(), features.right.levels.front(), point.u_px, point.v_px,
                         disparity_px, search);
}

/// Looks for the disparity between that of a point at rest and that of a point which moves along with the camera. Where
/// nothing is found there, it looks farther: the point may be on a vehicle that comes towards the camera or overtakes
/// it, at up to the camera's own speed.
std::optional<StereoMatch> expectedDisparity(const Features& features, const FlowObservation& point,
                                             const ExpectedDisparity& expected, bool motion_known, double offset_px) {
  const double middle_px = 0.5 * (expected.at_rest_px + expected.before_px) - offset_px,
               change_px = std::abs(expected.at_rest_px - expected.before_px);
  DisparityParams search;
  if (!motion_known) search.search_radius_px += kUnknownMotionSearch * expected.before_px;
  const auto within = [&](double reach_px) {
    DisparityParams wider = search;
    wider.search_radius_px += reach_px;
    return refineAround(features, point, middle_px, wider);
  };
  const auto between = within(0.5 * change_px);
  return between || change_px < search.search_radius_px ? between : within(1.5 * change_px);
}

}  // namespace

std::vector<std::optional<StereoObservation>> CircularMatching::operator()(const StereoMatches& stereo,
                                                                           const OpticalFlow& flow,
                                                                           const ExpectedDisparities& expected) const {
  const PointGrid corners(stereo.features->corners, camera_.width_px, camera_.height_px,
                          [](const Corner& c) { return Eigen::Vector2f(c.u_px, c.v_px); });
  const auto sigma_floor_px = static_cast<float>(params_.sigma_flow_px),
             sigma_disparity_floor_px = static_cast<float>(params_.sigma_disparity_px),
             offset_px = static_cast<float>(expected.offset_px);
  std::vector<std::optional<StereoObservation>> observed(flow.observations.size());
  const PointGrid points(flow.observations, camera_.width_px, camera_.height_px,
                         [](const FlowObservation& p) { return Eigen::Vector2f(p.u_px, p.v_px); });
  forEachItem(observed.size(), [&](std::size_t k) {
    const int i = points.byPlace()[k];
    const FlowObservation& point = flow.observations[i];
    const auto& before = expected.of_point[i];
    const auto match =
        before ? expectedDisparity(*stereo.features, point, *before, expected.motion_known, expected.offset_px)
               : firstDisparity(stereo, corners, point);
    if (!match) return;
    const float disparity_px = match->disparity_px + offset_px;
    if (!(disparity_px > 0)) return;
    const float sigma_px = std::max(point.sigma_px, sigma_floor_px);
    observed[i] = {.uvd_px = {point.u_px, point.v_px, disparity_px},
                   .sigma_px = {sigma_px, sigma_px, std::max(match->sigma_px, sigma_disparity_floor_px)}};
  });
  return observed;
}

/// Disparity of a new point, which stereo matching found at the point's corner. Where it did not, a matched corner
/// close by tells where to look.
std::optional<StereoMatch> CircularMatching::firstDisparity(const StereoMatches& stereo, const PointGrid& corners,
                                                            const FlowObservation& point) const {
  if (point.corner >= 0)
    if (auto match = refinedMatch(stereo, static_cast<std::size_t>(point.corner))) return match;
  const Eigen::Vector2f here(point.u_px, point.v_px), reach = Eigen::Vector2f::Constant(kNeighbor_px);
  std::pair tried(0.0F, -1);  // distance and number of a corner; of equal distances the first corner counts
  while (true) {
    std::pair nearest(kNeighbor_px, -1);
    corners.forEachNear(here - reach, here + reach, [&](int i) {
      if (!stereo.of_corner[i] || i == point.corner) return;
      const Corner& c = stereo.features->corners[i];
      const std::pair candidate((Eigen::Vector2f(c.u_px, c.v_px) - here).cwiseAbs().maxCoeff(), i);
      if (candidate > tried && candidate < nearest) nearest = candidate;
    });
    if (nearest.second < 0) return std::nullopt;
    if (const auto match = refinedMatch(stereo, static_cast<std::size_t>(nearest.second)))
      return refineAround(*stereo.features, point, match->disparity_px, {});
    tried = nearest;
  }
}

std::vector<Parameter> parametersOf(CircularMatching::Params& params) {
  return {numberParameter("sigma_flow_px", params.sigma_flow_px, {0.05, 2},
                          "the floor of what the image noise of your camera does to a followed point"),
          numberParameter("sigma_disparity_px", params.sigma_disparity_px, {0.05, 2}, "the same of a disparity")};
}

}  // namespace motorcade
