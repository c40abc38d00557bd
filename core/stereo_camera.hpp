#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/parameters.hpp"

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

/// Standard deviations of a rectified rig's calibration, whose errors are constant over a drive.
/// The defaults are those of a rig that was calibrated with care and then driven.
struct CalibrationSigmas {
  // What both cameras have in common.
  double focal = 0.002;      // of the focal length, as a share
  double middle_px = 0.7;    // of the principal point, each way
  double distortion = 0.01;  // of the radial term k1; a tenth of it of the tangential ones, p1 and p2
  double baseline = 0.001;   // as a share
  /// Disparity error that the right camera's yaw makes in the middle of the image. The errors by its roll, pitch, focal
  /// length and distortion are in proportion to it.
  double disparity_px = 0.15;

  bool operator==(const CalibrationSigmas&) const = default;
};
std::vector<Parameter> parametersOf(CalibrationSigmas& sigmas);
inline constexpr int kCalibrationSigmas = 5;

inline constexpr int kCalibrationErrors = 12;

/// Shifts of an observation (u, v, d) by each error of one standard deviation, to first order [px]. A shift is the
/// observation of a rig without the error minus the one that was made.
using ObservationShifts = Eigen::Matrix<double, 3, kCalibrationErrors>;
ObservationShifts observationShifts(const StereoCamera& camera, const CalibrationSigmas& sigmas,
                                    const Eigen::Vector3d& uvd_px);

}  // namespace motorcade
