#pragma once

#include <optional>

#include <Eigen/Core>

namespace motorcade {

/// A rectified stereo pair. Observations are (u, v, d): left pixel and disparity d = u_left - u_right, all in px.
/// Points are in the left camera's frame: x right, y down, z ahead [m].
struct StereoCamera {
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  double baseline_m = 0;
  int width_px = 0, height_px = 0;

  /// Empty when the point lies closer than `kMinDepth_m` ahead of the camera.
  std::optional<Eigen::Vector3d> project(const Eigen::Vector3d& p_cam) const;

  /// d(u, v, d) / d(p_cam) at a point ahead of the camera [px/m].
  Eigen::Matrix3d projectionJacobian(const Eigen::Vector3d& p_cam) const;

  /// The point of an observation with positive disparity.
  Eigen::Vector3d triangulate(const Eigen::Vector3d& uvd_px) const;

  /// d(p_cam) / d(u, v, d) [m/px].
  Eigen::Matrix3d triangulationJacobian(const Eigen::Vector3d& uvd_px) const;

  bool inLeftImage(double u_px, double v_px, double border_px = 0) const {
    return u_px >= border_px && v_px >= border_px && u_px <= width_px - 1 - border_px &&
           v_px <= height_px - 1 - border_px;
  }

  static constexpr double kMinDepth_m = 0.1;
};

}  // namespace motorcade
