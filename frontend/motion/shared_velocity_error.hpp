#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "core/elementary.hpp"
#include "core/messages.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// Covariance of the error that the velocities of all points near `p_cam` share [m^2/s^2, camera axes]. It comes from
/// the camera's own motion, and from disparities that change by calibration, not by motion, as the camera comes closer.
/// More points do not make it smaller. Errors of the camera's speed and of disparities grow with that speed, as they
/// are shares of its way; the error of its turn rate does not. The figures are those of drives in a town.
inline Eigen::Matrix3d sharedVelocityCovariance(const StereoCamera& camera, const Eigen::Vector3d& p_cam,
                                                double camera_speed_mps) {
  constexpr double kTownSpeed_mps = 13, kLeastShare = 0.2;  // at rest, the image noise of points at rest remains
  constexpr double kSpeed_mps = 0.25, kAngle_radps = 0.003, kDisparity_pxps = 0.15;
  const double share = std::clamp(camera_speed_mps / kTownSpeed_mps, kLeastShare, 1.0);
  const double z = p_cam.z(), range2 = p_cam.squaredNorm();
  const Eigen::Vector3d ray = p_cam / std::sqrt(range2);
  const double speed_mps = share * kSpeed_mps, across = speed_mps * speed_mps + range2 * kAngle_radps * kAngle_radps;
  const double along_mps = share * kDisparity_pxps * z * z / (camera.fx_px * camera.baseline_m);
  return across * Eigen::Matrix3d::Identity() + along_mps * along_mps * ray * ray.transpose();
}

/// Standard deviation of an object's speed [m/s], with the errors that all of its points share.
inline double speedSigma_mps(const ObjectEstimate& object, const SE3& T_world_cam, const StereoCamera& camera,
                             double camera_speed_mps) {
  const SE3 T_cam_world = T_world_cam.inverse();
  const Eigen::Vector3d velocity = T_cam_world.rotation() * object.velocity_world_mps;
  const Eigen::Matrix3d shared =
      sharedVelocityCovariance(camera, (T_cam_world * object.T_world_body).translation(), camera_speed_mps);
  const double squared = velocity.squaredNorm();
  const double along = squared > 0 ? velocity.dot(shared * velocity) / squared : shared.trace() / 3;
  return hypotenuse(object.speed_sigma_mps, std::sqrt(along));
}

}  // namespace motorcade
