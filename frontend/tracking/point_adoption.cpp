#include "frontend/tracking/point_adoption.hpp"

namespace motorcade {

BodyPoint PointAdoption::toBody(const TrackedObject& object, const ScenePoint& point) const {
  const SE3 T_body_cam = object.T_cam_body.inverse();
  const Eigen::Matrix3d J = T_body_cam.rotation() * camera_.triangulationJacobian(point.uvd_px);
  return {point.point, T_body_cam * camera_.triangulate(point.uvd_px),
          J * point.sigma_px.cwiseAbs2().asDiagonal() * J.transpose()};
}

/// Its velocity is the body's there, and not zero.
bool PointAdoption::movesWith(const TrackedObject& object, const ScenePoint& point, const SE3& T_world_cam) const {
  if (!point.flow) return false;
  return object.velocityChi2(*point.flow, T_world_cam) < params_.fits_chi2 &&
         point.flow->static_chi2 - point.flow->moving_chi2 > params_.not_static_chi2;
}

/// A long vehicle is found by and by; it is no wider or higher than others.
bool PointAdoption::couldBeOneBody(const Eigen::AlignedBox3d& box, double slack_m) const {
  const VehicleSize longest{params_.max_length_m, params_.vehicle.width_m, params_.vehicle.height_m};
  return longest.holds(box, slack_m);
}

void PointAdoption::operator()(TrackedObject& object, const SceneMotion& scene, const Segment* segment,
                               const SE3& T_world_cam, std::vector<bool>& taken) const {
  if (object.kinematics.speed_mps() < params_.min_speed_mps) return;
  const auto extent = object.extent(params_.margin_m);
  const auto known = object.extent(0);
  std::vector<BodyPoint> adopted;
  const auto consider = [&](std::size_t i) {
    const auto& p = scene.points[i];
    if (taken[i] || p.ambiguous || p.label == PointLabel::kGround) return;
    BodyPoint candidate = toBody(object, p);
    const double slack_m = params_.depth_noise_sigmas * std::sqrt(candidate.covariance.trace());
    const Eigen::AlignedBox3d grown = Eigen::AlignedBox3d(known).extend(candidate.p_body);
    const bool close = extent.exteriorDistance(candidate.p_body) < slack_m && couldBeOneBody(grown, slack_m);
    if (!close && !(segment && params_.vehicle.holds(grown, slack_m))) return;
    if (!movesWith(object, p, T_world_cam)) return;
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
