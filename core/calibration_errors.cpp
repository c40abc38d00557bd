#include "core/calibration_errors.hpp"

namespace motorcade {
namespace {

/// Disparity errors on rays 45 degrees up, up and sideways, or sideways, as shares of the error in the middle. Over a
/// KITTI image they come to .06 px; fields of .04 to .07 px are measured there.
constexpr double kRoll = 1 / 3.0, kPitch = 2 / 3.0, kFocal = 2 / 3.0, kDistortion = 4 / 3.0;

}  // namespace

std::vector<Parameter> parametersOf(CalibrationSigmas& sigmas) {
  const auto sigma = [](const char* name, double& value, double most, const char* gain) {
    return numberParameter(name, value, {0, most}, gain);
  };
  return {sigma("focal", sigmas.focal, 0.1,
                "how far the focal lengths may be off, as a share: standard deviation, part of all covariances; 0 "
                "where the calibration is exact"),
          sigma("middle_px", sigmas.middle_px, 50, "the same of the principal points, each way"),
          sigma("distortion", sigmas.distortion, 0.5, "the same of the lenses' radial term k1"),
          sigma("baseline", sigmas.baseline, 0.1, "the same of the cameras' distance, as a share"),
          sigma("disparity_px", sigmas.disparity_px, 10,
                "the same of disparities in the middle of the image, as the right camera is turned")};
}

ObservationShifts observationShifts(const StereoCamera& camera, const CalibrationSigmas& sigmas,
                                    const Eigen::Vector3d& uvd_px) {
  const double x = (uvd_px.x() - camera.cx_px) / camera.fx_px, y = (uvd_px.y() - camera.cy_px) / camera.fy_px,
               x_right = x - uvd_px.z() / camera.fx_px;
  const double r2 = x * x + y * y, r2_right = x_right * x_right + y * y;
  const double tangential = 0.1 * sigmas.distortion;
  ObservationShifts shifts;
  int column = 0;
  /// `left` and `right` are errors of u / fx in the two images, `down` that of v / fy in both; positive: too large.
  const auto addCommon = [&](double sigma, double left, double right, double down) {
    shifts.col(column++) =
        -sigma * Eigen::Vector3d(camera.fx_px * left, camera.fy_px * down, camera.fx_px * (left - right));
  };
  const auto addOfDisparity = [&](double sigma_px, double share) {
    shifts.col(column++) = Eigen::Vector3d(0, 0, sigma_px * share);
  };
  addCommon(sigmas.focal, x, x_right, y);
  addCommon(sigmas.middle_px / camera.fx_px, 1, 1, 0);
  addCommon(sigmas.middle_px / camera.fy_px, 0, 0, 1);
  addCommon(sigmas.distortion, x * r2, x_right * r2_right, y * r2);
  addCommon(tangential, 2 * x * y, 2 * x_right * y, r2 + 2 * y * y);
  addCommon(tangential, r2 + 2 * x * x, r2_right + 2 * x_right * x_right, 2 * x * y);
  addOfDisparity(sigmas.baseline, -uvd_px.z());
  addOfDisparity(sigmas.disparity_px, 1 + x_right * x_right);
  addOfDisparity(sigmas.disparity_px, kRoll * y);
  addOfDisparity(sigmas.disparity_px, kPitch * x_right * y);
  addOfDisparity(sigmas.disparity_px, kFocal * x_right);
  addOfDisparity(sigmas.disparity_px, kDistortion * x_right * r2_right);
  return shifts;
}

}  // namespace motorcade
