#pragma once

#include <cmath>

#include <Eigen/Core>

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

}  // namespace motorcade
