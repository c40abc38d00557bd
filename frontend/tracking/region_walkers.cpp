#include "frontend/tracking/region_walkers.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

#include <Eigen/LU>

#include "core/elementary.hpp"
#include "frontend/motion/shared_velocity_error.hpp"
#include "frontend/tracking/body_axes.hpp"
#include "frontend/tracking/see_through.hpp"
#include "frontend/tracking/small_body.hpp"
#include "frontend/tracking/trunk_windows.hpp"

namespace motorcade {
namespace {

constexpr double kSurely = 3;                // standard deviations of a walk, which is confirmed by as many
constexpr double kWalkerNotStaticChi2 = 16;  // by which moving explains better what was seen than resting: 4 sigma

double medianDisparity_px(const std::vector<int>& points, const SceneMotion& scene) {
  std::vector<const ScenePoint*> seen;
  for (const int i : points) seen.push_back(&scene.points[i]);
  return regionOf(seen)->disparity_px;
}

/// Velocity of a component, expected to be as small as a standard deviation, and how well both agree: twice the
/// negative logarithm of their likelihood.
struct ExpectedVelocity {
  Eigen::Vector3d velocity_mps;
  Eigen::Matrix3d covariance;
  double misfit;

  ExpectedVelocity(const MotionComponent& component, double sigma_mps) {
    const Eigen::Vector3d& v = component.velocity_mps;
    const Eigen::Matrix3d& C = component.velocity_covariance;
    const Eigen::Matrix3d both = C + sigma_mps * sigma_mps * Eigen::Matrix3d::Identity(), gain = C * both.inverse();
    velocity_mps = v - gain * v;
    covariance = C - gain * C;
    misfit = v.dot(both.inverse() * v) + logarithm(both.determinant());
  }
};

/// Expects a walk's speed along the line of sight, or else a ride's, as the flow tells little of the velocity there.
void expectUsual(MotionComponent& component) {
  constexpr double kWalk_mps = 1.5, kRide_mps = 5;
  const ExpectedVelocity walk(component, kWalk_mps), ride(component, kRide_mps);
  const ExpectedVelocity& likelier = walk.misfit < ride.misfit ? walk : ride;
  component.velocity_mps = likelier.velocity_mps;
  component.velocity_covariance = likelier.covariance;
}

/// True when moving explains the places of a region that no label shows, and its brightness, too, is explained by
/// moving and not by resting. Where a pole or a fence hides the background, parts of both may look like a body, and are
/// found elsewhere by chance.
bool isProven(const RegionFlow::Seen& seen) {
  const double degrees_of_freedom = 3 * seen.flow.observations - 6;
  return seen.flow.moving_chi2 < degrees_of_freedom && seen.not_static_chi2 > kWalkerNotStaticChi2;
}

bool isSure(const MotionComponent& component) {
  const Eigen::Vector3d& v = component.velocity_mps;
  return v.dot(component.velocity_covariance.inverse() * v) > kSurely * kSurely;
}

}  // namespace

std::vector<RegionWalkers::Candidate> RegionWalkers::candidates(const SceneMotion& scene,
                                                                const std::vector<bool>& taken,
                                                                const std::vector<bool>& on_objects,
                                                                const SE3& T_world_cam) const {
  std::vector<Candidate> all = labelled(scene, taken);
  for (TrunkWindow& window : TrunkWindows(flow_of_, camera_)(scene, on_objects, T_world_cam))
    all.push_back({{0, window.box}, {window.point}, scene.points[window.point].uvd_px.z(), std::move(window.pixels)});
  return all;
}

std::vector<RegionWalkers::Candidate> RegionWalkers::labelled(const SceneMotion& scene,
                                                              const std::vector<bool>& taken) const {
  constexpr std::size_t kMost = 32;  // each takes about a millisecond
  if (!scene.features->frame->inputs.instances) return {};
  const InstanceLabels& labels = *scene.features->frame->inputs.instances;
  std::map<std::uint16_t, std::vector<int>> points_of;
  for (int i = 0; i < static_cast<int>(scene.points.size()); ++i)
    if (scene.points[i].instance != 0 && scene.points[i].label != PointLabel::kGround)
      points_of[scene.points[i].instance].push_back(i);
  std::vector<Candidate> all;
  for (const InstanceRegion& region : regionsOf(labels)) {
    const auto points = points_of.find(region.label);
    if (points == points_of.end()) continue;
    if (std::ranges::any_of(points->second, [&](int i) { return bool{taken[i]}; })) continue;
    const double disparity_px = medianDisparity_px(points->second, scene);
    if (isLikeAPerson(region, disparity_px)) all.push_back({region, std::move(points->second), disparity_px});
  }
  if (all.size() > kMost) {
    const std::size_t first = static_cast<std::size_t>(scene.head.frame.value) * kMost % all.size();
    std::rotate(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(first), all.end());
    all.resize(kMost);
  }
  for (Candidate& candidate : all) candidate.pixels = pixelsOf(candidate.region, labels);
  return all;
}

std::optional<RegionWalkers::Mover> RegionWalkers::operator()(const Candidate& candidate, const SceneMotion& scene,
                                                              const SE3& T_world_cam) const {
  const double disparity_px = candidate.disparity_px;
  constexpr double kMostFrames = 0.6;  // of those that are looked at
  const bool is_labelled = candidate.region.label != 0;
  // Beside a label that is late, or lies across a body, the body goes on; beside one on a wall the wall does.
  if (is_labelled && !standsOut(upperPart(candidate.region.box), disparity_px, scene)) return std::nullopt;
  const auto seen = flow_of_(candidate.pixels, disparity_px, scene, T_world_cam, is_labelled ? 0 : kMostFrames);
  if (!seen || seen->flow.static_chi2 - seen->flow.moving_chi2 < kWalkerNotStaticChi2) return std::nullopt;
  if (!is_labelled && !isProven(*seen)) return std::nullopt;
  Mover mover{
      .component = {}, .frames = seen->flow.observations, .duration_s = seen->duration_s, .labelled = is_labelled};
  MotionComponent& component = mover.component;
  for (const int i : candidate.points)
    if (mayBeOn(seen->flow, scene.points[i])) component.points.push_back(i);
  component.centroid_cam = seen->flow.p_cam;
  component.velocity_mps = seen->flow.velocity_mps;
  component.velocity_covariance = seen->flow.covariance.bottomRightCorner<3, 3>() +
                                  sharedVelocityCovariance(camera_, component.centroid_cam, scene.camera_speed_mps);
  if (!isSure(component)) return std::nullopt;
  expectUsual(component);
  const double speed_mps = component.velocity_mps.norm();
  const bool rides = speed_mps > kFastestWalk_mps && speed_mps < kFastestRide_mps;
  if (!rides && !isWalk(speed_mps, component.centroid_cam.z(), camera_)) return std::nullopt;
  return mover;
}

/// True when a point is as far away as the person, and moves alike as far as is known.
bool RegionWalkers::mayBeOn(const SceneFlow& person, const ScenePoint& point) const {
  constexpr double kDeep_m = 0.5, kNoiseSigmas = 2, kAlikeChi2 = 11.3;  // 3 degrees of freedom: 99 %
  const double z_m = camera_.triangulate(point.uvd_px).z(), noise_m = z_m * point.sigma_px.z() / point.uvd_px.z();
  if (std::abs(z_m - person.p_cam.z()) > kDeep_m + kNoiseSigmas * noise_m) return false;
  if (!point.flow) return true;
  const Eigen::Vector3d dv = point.flow->velocity_mps - person.velocity_mps;
  const Eigen::Matrix3d C = (point.flow->covariance + person.covariance).bottomRightCorner<3, 3>();
  return dv.dot(C.inverse() * dv) < kAlikeChi2;
}

/// True for a region of a person's size. A label may show less than all of somebody, but not more.
bool RegionWalkers::isLikeAPerson(const InstanceRegion& region, double disparity_px) const {
  constexpr double kLeast_m = 0.5, kNoise_m = 0.2;
  const double m_per_px = camera_.baseline_m / disparity_px;
  const double width_m = (region.box.right_px - region.box.left_px) * m_per_px,
               height_m = (region.box.bottom_px - region.box.top_px) * m_per_px * camera_.fx_px / camera_.fy_px;
  return height_m > kLeast_m && height_m < kPerson.height_m + kNoise_m && width_m < kPerson.length_m + kNoise_m;
}

}  // namespace motorcade
