#pragma once

#include <array>

#include "apps/synth/rendering/rays.hpp"
#include "core/calibration_errors.hpp"

namespace motorcade::synth {

/// Errors of a rig's calibration, each in its standard deviations, in the order of the columns of ObservationShifts.
using CalibrationErrors = std::array<double, kCalibrationErrors>;

/// The rays of a camera with errors: each of its pixels takes that of another pixel of a camera without errors.
class LensErrors {
 public:
  struct Pixel {
    float u_px, v_px;
  };
  LensErrors(const StereoCamera& camera, StereoSide side, const CalibrationErrors& errors);

  Pixel exact(float u_px, float v_px) const;
  /// Largest distance of such a pixel outside of the image.
  float beyond_px() const;

 private:
  StereoCamera camera_;
  StereoSide side_;
  Eigen::Matrix<double, kCalibrationErrors, 1> errors_;
};

}  // namespace motorcade::synth
