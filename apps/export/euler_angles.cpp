#include "apps/export/euler_angles.hpp"

#include <algorithm>
#include <cmath>

namespace motorcade {
namespace {

constexpr double kVertical = 1e-6;       // cosine of a pitch that is a right angle, for the angles themselves
constexpr double kLeastCosine = 8.7e-3;  // of the pitch, for their rates

}  // namespace

Eigen::Vector3d eulerAngles_rad(const Eigen::Matrix3d& rotation) {
  const double pitch = std::asin(std::clamp(-rotation(2, 0), -1.0, 1.0));
  if (std::hypot(rotation(0, 0), rotation(1, 0)) < kVertical)
    return {0, pitch, std::atan2(-rotation(0, 1), rotation(1, 1))};
  return {std::atan2(rotation(2, 1), rotation(2, 2)), pitch, std::atan2(rotation(1, 0), rotation(0, 0))};
}

std::optional<Eigen::Matrix3d> eulerJacobian(const Eigen::Vector3d& angles_rad) {
  const double sin_roll = std::sin(angles_rad[0]), cos_roll = std::cos(angles_rad[0]);
  const double sin_pitch = std::sin(angles_rad[1]), cos_pitch = std::cos(angles_rad[1]);
  if (cos_pitch < kLeastCosine) return std::nullopt;
  Eigen::Matrix3d J;
  J << 1, sin_roll * sin_pitch / cos_pitch, cos_roll * sin_pitch / cos_pitch,  //
      0, cos_roll, -sin_roll,                                                  //
      0, sin_roll / cos_pitch, cos_roll / cos_pitch;
  return J;
}

}  // namespace motorcade
