#pragma once

#include <vector>

#include "core/se3.hpp"

namespace motorcade {

/// The covariance that a real drive's truth adds to errors of the camera's motion over `kCameraCovarianceFrames`.
///
/// The gyroscopes of KITTI's inertial unit err by .01 deg. White noise of the truth's poses shows in the motions from
/// one frame to the next. Successive errors cancel: their covariance is minus the variance of one pose. A motion has
/// twice that variance. An estimate that errs in the same way is forgiven for it.
Matrix6d truthNoise(const std::vector<SE3>& estimate, const std::vector<SE3>& truth);

/// The mean squared difference of the camera's motion over as many frames between two truths, along its axes [m^2]: one
/// by measured positions, one by measured velocities.
Eigen::Matrix3d placeNoise(const std::vector<SE3>& by_position, const std::vector<SE3>& by_velocity);

}  // namespace motorcade
