#include "frontend/motion/camera_mounting.hpp"

#include <algorithm>

namespace motorcade {
namespace {

constexpr double kTilt = 0.03;     // a car pitches and rolls by a degree, and a road bends as much within 30 m
constexpr double kHeight_m = 0.1;  // a car heaves by some centimeters; a bend in the road looks like a decimeter

}  // namespace

void CameraMounting::add(const GroundPlane& found) {
  found_[count_++ % kRemembered] = found;
  const std::size_t count = std::min(count_, kRemembered);
  std::array<double, kRemembered> values;
  const auto median = [&](auto valueOf) {
    std::transform(found_.begin(), found_.begin() + count, values.begin(), valueOf);
    std::nth_element(values.begin(), values.begin() + count / 2, values.begin() + count);
    return values[count / 2];
  };
  for (int axis = 0; axis < 3; ++axis)
    plane_.normal_cam[axis] = median([axis](const GroundPlane& p) { return p.normal_cam[axis]; });
  plane_.normal_cam.normalize();
  plane_.height_m = median([](const GroundPlane& p) { return p.height_m; });
}

double CameraMounting::likelihoodOf(const GroundPlane& plane) const {
  if (!isKnown()) return 1;
  const double tilt = (plane.normal_cam - plane_.normal_cam).norm() / kTilt,
               height = (plane.height_m - plane_.height_m) / kHeight_m;
  return 1 / (1 + tilt * tilt + height * height);
}

}  // namespace motorcade
