#pragma once

#include <vector>

#include "core/se3.hpp"

namespace motorcade {

/// How far a real drive's truth may be off: the covariance that it adds to errors of the camera's motion over
/// `kCameraCovarianceFrames`.
///
/// The gyroscopes of KITTI's inertial unit turn by .01 deg too much or too little. What is white in its poses shows in
/// the errors of successive motions, from one frame to the next, as one takes back what the other had too much: by
/// minus the variance of one pose, twice of which is in a motion. An estimate that errs so itself is forgiven for it.
Matrix6d truthNoise(const std::vector<SE3>& estimate, const std::vector<SE3>& truth);

/// By how much places as measured and places to which the measured velocities lead differ over so many frames, mean
/// squares along the camera's axes [m^2].
Eigen::Matrix3d placeNoise(const std::vector<SE3>& by_position, const std::vector<SE3>& by_velocity);

}  // namespace motorcade
