#include "frontend/point_adoption.hpp"

#include <algorithm>

#include <Eigen/LU>

#include "frontend/object_motion.hpp"

namespace motorcade {

BodyPoint PointAdoption::toBody(const TrackedObject& object, const ScenePoint& point) const {
  const SE3 T_body_cam = object.T_cam_body.inverse();
  const Eigen::Matrix3d J = T_body_cam.rotation() * camera_.triangulationJacobian(point.uvd_px);
  return {point.point, T_body_cam * camera_.triangulate(point.uvd_px), J * point.sigma_px.cwiseAbs2().asDiagonal() * J.transpose()};
}

/// With scene flow: its velocity is the body's there, and not zero. Without: the body's motion explains both sightings, rest does not.
bool PointAdoption::movesWith(const TrackedObject& object, const ScenePoint& point, const SceneMotion& scene,
                              const SceneMotion* previous_scene, const SE3& T_world_cam) const {
  if (point.flow) {
    const Eigen::Matrix3d& R = T_world_cam.rotation();
    const Eigen::Vector3d p_body = object.T_cam_body.inverse() * point.flow->p_cam;
    const Eigen::Vector3d difference = R * point.flow->velocity_mps - object.velocityAt_mps(p_body);
    const Eigen::Matrix3d R_body = object.kinematics.pose().rotation();
    const Eigen::Matrix3d S = R * point.flow->covariance.bottomRightCorner<3, 3>() * R.transpose() +
                              R_body * object.kinematics.velocityCovariance() * R_body.transpose() + 0.25 * Eigen::Matrix3d::Identity();
    return difference.dot(S.inverse() * difference) < params_.fits_chi2 &&
           point.flow->static_chi2 - point.flow->moving_chi2 > params_.not_static_chi2;
  }
  const auto* before = previous_scene ? findPoint(*previous_scene, point.point) : nullptr;
  if (!before || !object.seen_before.valid() || object.seen_before != previous_scene->frame) return false;
  const Eigen::Matrix3d J = camera_.triangulationJacobian(before->uvd_px);
  const PoseObservation o{camera_.triangulate(before->uvd_px), J * before->sigma_px.cwiseAbs2().asDiagonal() * J.transpose(), point.uvd_px,
                          point.sigma_px};
  const SE3 T_now_before_on_body = object.T_cam_body * object.T_cam_body_before.inverse();
  return poseChi2(camera_, o, T_now_before_on_body) < params_.fits_chi2 &&
         poseChi2(camera_, o, scene.T_previous_now.inverse()) > params_.not_static_chi2;
}

void PointAdoption::operator()(TrackedObject& object, const SceneMotion& scene, const SceneMotion* previous_scene, const Segment* segment,
                               const SE3& T_world_cam, std::vector<bool>& taken) const {
  if (object.kinematics.speed_mps() < params_.min_speed_mps) return;
  const auto extent = object.extent(params_.margin_m);
  const auto known = object.extent(0);
  std::vector<BodyPoint> adopted;
  const auto consider = [&](std::size_t i) {
    const auto& p = scene.points[i];
    if (taken[i] || p.repeats || p.label == PointLabel::kGround) return;
    BodyPoint candidate = toBody(object, p);
    const double slack_m = params_.depth_noise_sigmas * std::sqrt(candidate.covariance.trace());
    const Eigen::AlignedBox3d grown = Eigen::AlignedBox3d(known).extend(candidate.p_body);
    const bool close = extent.exteriorDistance(candidate.p_body) < slack_m && grown.sizes().maxCoeff() < params_.max_length_m + slack_m;
    if (!close && !(segment && params_.vehicle.holds(grown, slack_m))) return;
    if (!movesWith(object, p, scene, previous_scene, T_world_cam)) return;
    taken[i] = true;
    adopted.push_back(candidate);
  };
  if (segment) {
    for (const int i : segment->points) consider(static_cast<std::size_t>(i));
  } else {
    for (std::size_t i = 0; i < scene.points.size(); ++i) consider(i);
  }
  object.adopt(adopted);
}

}  // namespace motorcade
