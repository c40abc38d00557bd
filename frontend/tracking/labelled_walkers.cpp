#include "frontend/tracking/labelled_walkers.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

#include <Eigen/LU>

#include "frontend/motion/shared_velocity_error.hpp"
#include "frontend/tracking/body_axes.hpp"
#include "frontend/tracking/see_through.hpp"
#include "frontend/tracking/small_body.hpp"

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
    misfit = v.dot(both.inverse() * v) + std::log(both.determinant());
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

bool isSure(const MotionComponent& component) {
  const Eigen::Vector3d& v = component.velocity_mps;
  return v.dot(component.velocity_covariance.inverse() * v) > kSurely * kSurely;
}

}  // namespace

std::vector<LabelledWalkers::Candidate> LabelledWalkers::candidates(const SceneMotion& scene,
                                                                    const std::vector<bool>& taken) const {
  constexpr std::size_t kMost = 32;  // each takes about a millisecond
  std::map<std::uint16_t, std::vector<int>> points_of;
  for (int i = 0; i < static_cast<int>(scene.points.size()); ++i)
    if (scene.points[i].instance != 0 && scene.points[i].label != PointLabel::kGround)
      points_of[scene.points[i].instance].push_back(i);
  std::vector<Candidate> all;
  for (const InstanceRegion& region : regionsOf(*scene.features->frame->inputs.instances)) {
    const auto points = points_of.find(region.label);
    if (points == points_of.end()) continue;
    if (std::ranges::any_of(points->second, [&](int i) { return bool{taken[i]}; })) continue;
    const double disparity_px = medianDisparity_px(points->second, scene);
    if (isLikeAPerson(region, disparity_px)) all.push_back({region, std::move(points->second), disparity_px});
  }
  if (all.size() <= kMost) return all;
  const std::size_t first = static_cast<std::size_t>(scene.head.frame.value) * kMost % all.size();
  std::rotate(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(first), all.end());
  all.resize(kMost);
  return all;
}

std::optional<LabelledWalkers::Mover> LabelledWalkers::operator()(const Candidate& candidate, const SceneMotion& scene,
                                                                  const SE3& T_world_cam) const {
  const InstanceRegion& region = candidate.region;
  const double disparity_px = candidate.disparity_px;
  if (!endsWhereItsBodyDoes(region, disparity_px, scene)) return std::nullopt;
  const auto seen = flow_of_(region, disparity_px, scene, T_world_cam);
  if (!seen || seen->flow.static_chi2 - seen->flow.moving_chi2 < kWalkerNotStaticChi2) return std::nullopt;
  Mover mover{.component = {}, .frames = seen->flow.observations, .duration_s = seen->duration_s};
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
bool LabelledWalkers::mayBeOn(const SceneFlow& person, const ScenePoint& point) const {
  constexpr double kDeep_m = 0.5, kNoiseSigmas = 2, kAlikeChi2 = 11.3;  // 3 degrees of freedom: 99 %
  const double z_m = camera_.triangulate(point.uvd_px).z(), noise_m = z_m * point.sigma_px.z() / point.uvd_px.z();
  if (std::abs(z_m - person.p_cam.z()) > kDeep_m + kNoiseSigmas * noise_m) return false;
  if (!point.flow) return true;
  const Eigen::Vector3d dv = point.flow->velocity_mps - person.velocity_mps;
  const Eigen::Matrix3d C = (point.flow->covariance + person.covariance).bottomRightCorner<3, 3>();
  return dv.dot(C.inverse() * dv) < kAlikeChi2;
}

/// True for a region of a person's size. A label may show less than all of somebody, but not more.
bool LabelledWalkers::isLikeAPerson(const InstanceRegion& region, double disparity_px) const {
  constexpr double kLeast_m = 0.5, kNoise_m = 0.2;
  const double m_per_px = camera_.baseline_m / disparity_px;
  const double width_m = (region.box.right_px - region.box.left_px) * m_per_px,
               height_m = (region.box.bottom_px - region.box.top_px) * m_per_px * camera_.fx_px / camera_.fy_px;
  return height_m > kLeast_m && height_m < kPerson.height_m + kNoise_m && width_m < kPerson.length_m + kNoise_m;
}

/// True when what lies to both sides of the region, along its upper part, has another depth than the region itself.
/// Beside a label that is late, or lies across a body, the body goes on; beside one on a wall the wall does.
bool LabelledWalkers::endsWhereItsBodyDoes(const InstanceRegion& region, double disparity_px,
                                           const SceneMotion& scene) {
  constexpr double kMargin_px = 4, kLeastWide_px = 12;
  constexpr double kLeastInside = 0.3, kMostBeside = 0.5;  // of the share inside: clothes may be smooth
  const Box inside = upperPart(region.box);
  const double wide_px = std::max(kLeastWide_px, 0.5 * (inside.right_px - inside.left_px));
  Box left = inside, right = inside;
  left.right_px = inside.left_px - kMargin_px, left.left_px = left.right_px - wide_px;
  right.left_px = inside.right_px + kMargin_px, right.right_px = right.left_px + wide_px;
  const auto share = [&](const Box& box) {
    return shareAtDepth(*scene.features, box, disparity_px, scene.disparity_offset_px);
  };
  const double own = share(inside);
  return own > kLeastInside && share(left) < kMostBeside * own && share(right) < kMostBeside * own;
}

}  // namespace motorcade
