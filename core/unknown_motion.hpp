#pragma once

#include <algorithm>

#include "core/se3.hpp"

namespace motorcade {

/// Standard deviations over a tenth of a second of a camera motion that was not measured, about the motion before it.
/// Hard braking (8 m/s^2) changes it by 0.08 m in that time, and a sharp turn by about 0.02 rad.
constexpr double kUnknownMotion_m = 0.3, kUnknownMotion_rad = 0.02, kUnknownMotion_s = 0.1;
/// Limits of the standard deviations, which grow in proportion to time: beyond these, nothing is known.
constexpr double kMaxUnknownMotion_m = 30, kMaxUnknownMotion_rad = 0.5;

inline Matrix6d unknownMotionCovariance(double dt_s = kUnknownMotion_s) {
  const double times = std::max(1.0, dt_s / kUnknownMotion_s);
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(std::min(times * kUnknownMotion_m, kMaxUnknownMotion_m)),
      Eigen::Vector3d::Constant(std::min(times * kUnknownMotion_rad, kMaxUnknownMotion_rad));
  return sigma.cwiseAbs2().asDiagonal();
}

}  // namespace motorcade
