#pragma once

#include <cmath>

#include <Eigen/Core>

#include "core/elementary.hpp"
#include "core/messages.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// Covariance of the error that the velocities of all points near `p_cam` share [m^2/s^2, camera axes]: that of the
/// camera's own motion, and of disparities that change by calibration, not by motion, as the camera comes closer. More
/// points do not make it smaller.
inline Eigen::Matrix3d sharedVelocityCovariance(const StereoCamera& camera, const Eigen::Vector3d& p_cam) {
  constexpr double kSpeed_mps = 0.25, kAngle_radps = 0.003, kDisparity_pxps = 0.15;
  const double z = p_cam.z(), range2 = p_cam.squaredNorm();
  const Eigen::Vector3d ray = p_cam / std::sqrt(range2);
  const double across = kSpeed_mps * kSpeed_mps + range2 * kAngle_radps * kAngle_radps;
  const double along_mps = kDisparity_pxps * z * z / (camera.fx_px * camera.baseline_m);
  return across * Eigen::Matrix3d::Identity() + along_mps * along_mps * ray * ray.transpose();
}

/// Standard deviation of an object's speed [m/s], with the errors that all of its points share.
inline double speedSigma_mps(const ObjectEstimate& object, const SE3& T_world_cam, const StereoCamera& camera) {
  const SE3 T_cam_world = T_world_cam.inverse();
  const Eigen::Vector3d velocity = T_cam_world.rotation() * object.velocity_world_mps;
  const Eigen::Matrix3d shared = sharedVelocityCovariance(camera, (T_cam_world * object.T_world_body).translation());
  const double squared = velocity.squaredNorm();
  const double along = squared > 0 ? velocity.dot(shared * velocity) / squared : shared.trace() / 3;
  return hypotenuse(object.speed_sigma_mps, std::sqrt(along));
}

}  // namespace motorcade
