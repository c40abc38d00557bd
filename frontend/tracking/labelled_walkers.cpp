#include "frontend/tracking/labelled_walkers.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "frontend/motion/shared_velocity_error.hpp"
#include "frontend/tracking/small_body.hpp"
#include "frontend/tracking/vehicle_size.hpp"

namespace motorcade {
namespace {

constexpr double kSurely = 3;          // standard deviations of a walk, which is confirmed by as many
constexpr double kNotStaticChi2 = 16;  // by which moving explains better what was seen than resting: 4 sigma

double medianDisparity_px(const std::vector<int>& points, const SceneMotion& scene) {
  std::vector<double> disparities_px;
  for (const int i : points) disparities_px.push_back(scene.points[i].uvd_px.z());
  const auto middle = disparities_px.begin() + std::ssize(disparities_px) / 2;
  std::ranges::nth_element(disparities_px, middle);
  return *middle;
}

/// Along the line of sight the flow tells little of a velocity, and people walk at about the same speed.
void expectWalk(MotionComponent& component) {
  constexpr double kSpeed_mps = 1.5;
  const Eigen::Matrix3d W = component.velocity_covariance.inverse();
  const Eigen::Matrix3d both = W + Eigen::Matrix3d::Identity() / (kSpeed_mps * kSpeed_mps);
  component.velocity_covariance = both.inverse();
  component.velocity_mps = component.velocity_covariance * W * component.velocity_mps;
}

}  // namespace

std::optional<MotionComponent> LabelledWalkers::operator()(const InstanceRegion& region, const SceneMotion& scene,
                                                           const SE3& T_world_cam,
                                                           const std::vector<bool>& taken) const {
  MotionComponent component;
  component.points = pointsIn(region, scene);
  const auto is_taken = [&](int i) { return bool{taken[i]}; };
  if (component.points.empty() || std::ranges::any_of(component.points, is_taken)) return std::nullopt;
  const double disparity_px = medianDisparity_px(component.points, scene);
  if (!isLikeAPerson(region, disparity_px)) return std::nullopt;
  const auto flow = flow_of_(region, disparity_px, scene, T_world_cam);
  if (!flow || flow->static_chi2 - flow->moving_chi2 < kNotStaticChi2) return std::nullopt;
  std::erase_if(component.points, [&](int i) { return !mayBeOn(*flow, scene.points[i]); });
  component.centroid_cam = flow->p_cam;
  component.velocity_mps = flow->velocity_mps;
  component.velocity_covariance = flow->covariance.bottomRightCorner<3, 3>() +
                                  sharedVelocityCovariance(camera_, flow->p_cam, scene.camera_speed_mps);
  const Eigen::Vector3d& v = component.velocity_mps;
  if (v.dot(component.velocity_covariance.inverse() * v) < kSurely * kSurely) return std::nullopt;
  expectWalk(component);
  if (!isWalk(v.norm(), component.centroid_cam.z(), camera_)) return std::nullopt;
  return component;
}

std::vector<int> LabelledWalkers::pointsIn(const InstanceRegion& region, const SceneMotion& scene) {
  std::vector<int> points;
  for (int i = 0; i < static_cast<int>(scene.points.size()); ++i)
    if (scene.points[i].instance == region.label && scene.points[i].label != PointLabel::kGround) points.push_back(i);
  return points;
}

/// Is a point as far away as the person, and does it move alike as far as is known?
bool LabelledWalkers::mayBeOn(const SceneFlow& person, const ScenePoint& point) const {
  constexpr double kDeep_m = 0.5, kSigmas = 2, kAlikeChi2 = 11.3;  // 3 degrees of freedom: 99 %
  const double z_m = camera_.triangulate(point.uvd_px).z(), noise_m = z_m * point.sigma_px.z() / point.uvd_px.z();
  if (std::abs(z_m - person.p_cam.z()) > kDeep_m + kSigmas * noise_m) return false;
  if (!point.flow) return true;
  const Eigen::Vector3d dv = point.flow->velocity_mps - person.velocity_mps;
  const Eigen::Matrix3d C = (point.flow->covariance + person.covariance).bottomRightCorner<3, 3>();
  return dv.dot(C.inverse() * dv) < kAlikeChi2;
}

/// A label may show less than all of somebody, but not more.
bool LabelledWalkers::isLikeAPerson(const InstanceRegion& region, double disparity_px) const {
  constexpr double kLeast_m = 0.5, kNoise_m = 0.2;
  const double m_per_px = camera_.baseline_m / disparity_px;
  const double width_m = (region.box.right_px - region.box.left_px) * m_per_px,
               height_m = (region.box.bottom_px - region.box.top_px) * m_per_px * camera_.fx_px / camera_.fy_px;
  return height_m > kLeast_m && height_m < kPerson.height_m + kNoise_m && width_m < kPerson.length_m + kNoise_m;
}

}  // namespace motorcade
