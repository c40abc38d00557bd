#include "apps/synth/rendering/lens_errors.hpp"

#include <algorithm>
#include <cmath>

namespace motorcade::synth {

LensErrors::LensErrors(const StereoCamera& camera, StereoSide side, const CalibrationErrors& errors)
    : camera_(camera), side_(side), errors_(errors.data()) {}

/// Uses observations of a point far away: the right camera's error beyond the left one's is that of the disparity.
LensErrors::Pixel LensErrors::exact(float u_px, float v_px) const {
  if (errors_.isZero()) return {u_px, v_px};
  const Eigen::Vector3d shift = observationShifts(camera_, CalibrationSigmas{}, {u_px, v_px, 0}) * errors_;
  const double du_px = side_ == StereoSide::kLeft ? shift.x() : shift.x() - shift.z();
  return {u_px + static_cast<float>(du_px), v_px + static_cast<float>(shift.y())};
}

float LensErrors::beyond_px() const {
  float beyond_px = 0;
  for (const float u_px : {0.0F, static_cast<float>(camera_.width_px)}) {
    for (const float v_px : {0.0F, static_cast<float>(camera_.height_px)}) {
      const Pixel corner = exact(u_px, v_px);
      beyond_px = std::max({beyond_px, std::abs(corner.u_px - u_px), std::abs(corner.v_px - v_px)});
    }
  }
  return beyond_px;
}

}  // namespace motorcade::synth
