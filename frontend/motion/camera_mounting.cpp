#include "frontend/motion/camera_mounting.hpp"

#include <algorithm>

namespace motorcade {
namespace {

// Usual differences from the mounting. Roads are crowned and banked by 0.025 and more, and a car leans by as much in a
// bend. It heaves by some centimeters, and a change of slope ahead looks like a decimeter.
constexpr double kTilt_rad = 0.06, kHeight_m = 0.15;
// The same of the assumed mounting, which is that of most cars.
constexpr double kAssumedTilt_rad = 0.12, kAssumedHeight_m = 0.5;

}  // namespace

void CameraMounting::add(const GroundPlane& found) {
  found_[count_++ % kRemembered] = found;
  const std::size_t count = std::min(count_, kRemembered);
  std::array<double, kRemembered> values;
  const auto median = [&](auto value_of) {
    std::transform(found_.begin(), found_.begin() + count, values.begin(), value_of);
    std::nth_element(values.begin(), values.begin() + count / 2, values.begin() + count);
    return values[count / 2];
  };
  for (int axis = 0; axis < 3; ++axis)
    median_.normal_cam[axis] = median([axis](const GroundPlane& p) { return p.normal_cam[axis]; });
  median_.normal_cam.normalize();
  median_.height_m = median([](const GroundPlane& p) { return p.height_m; });
}

double CameraMounting::likelihoodOf(const GroundPlane& plane) const {
  const double usual_rad = isKnown() ? kTilt_rad : kAssumedTilt_rad, usual_m = isKnown() ? kHeight_m : kAssumedHeight_m;
  const double tilt = (plane.normal_cam - this->plane().normal_cam).norm() / usual_rad,
               height = (plane.height_m - this->plane().height_m) / usual_m;
  return 1 / std::max(1.0, tilt * tilt + height * height);
}

Eigen::Matrix3d levelAxes(const Eigen::Vector3d& normal_cam) {
  const Eigen::Vector3d optical_axis = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d ahead = (optical_axis - normal_cam * normal_cam.dot(optical_axis)).normalized();
  Eigen::Matrix3d R_cam_level;
  R_cam_level << normal_cam.cross(ahead), normal_cam, ahead;
  return R_cam_level;
}

}  // namespace motorcade
