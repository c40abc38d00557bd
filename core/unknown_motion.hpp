#pragma once

#include "core/se3.hpp"

namespace motorcade {

/// Standard deviations of a camera motion from frame to frame that could not be measured. The motion before it is taken
/// to go on: at ten frames a second, hard braking (8 m/s^2) changes it by 0.08 m a frame, and a sharp turn by about
/// 0.02 rad.
constexpr double kUnknownMotion_m = 0.3, kUnknownMotion_rad = 0.02;

inline Matrix6d unknownMotionCovariance() {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(kUnknownMotion_m), Eigen::Vector3d::Constant(kUnknownMotion_rad);
  return sigma.cwiseAbs2().asDiagonal();
}

}  // namespace motorcade
