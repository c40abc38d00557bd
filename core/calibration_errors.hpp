#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/parameters.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

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
