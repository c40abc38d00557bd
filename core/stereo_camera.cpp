#include "core/stereo_camera.hpp"

#include <cassert>

namespace motorcade {

std::optional<Eigen::Vector3d> StereoCamera::project(const Eigen::Vector3d& p_cam) const {
  if (p_cam.z() < kMinDepth_m) return std::nullopt;
  const double inverse_z = 1.0 / p_cam.z();
  return Eigen::Vector3d{fx_px * p_cam.x() * inverse_z + cx_px, fy_px * p_cam.y() * inverse_z + cy_px,
                         fx_px * baseline_m * inverse_z};
}

Eigen::Matrix3d StereoCamera::projectionJacobian(const Eigen::Vector3d& p_cam) const {
  const double iz = 1.0 / p_cam.z(), iz2 = iz * iz;
  Eigen::Matrix3d J;
  J << fx_px * iz, 0, -fx_px * p_cam.x() * iz2,  //
      0, fy_px * iz, -fy_px * p_cam.y() * iz2,   //
      0, 0, -fx_px * baseline_m * iz2;
  return J;
}

Eigen::Vector3d StereoCamera::triangulate(const Eigen::Vector3d& uvd_px) const {
  assert(uvd_px.z() > 0);
  const double z = fx_px * baseline_m / uvd_px.z();
  return {(uvd_px.x() - cx_px) * z / fx_px, (uvd_px.y() - cy_px) * z / fy_px, z};
}

Eigen::Matrix3d StereoCamera::triangulationJacobian(const Eigen::Vector3d& uvd_px) const {
  const Eigen::Vector3d p = triangulate(uvd_px);
  const double inverse_d = 1.0 / uvd_px.z();
  Eigen::Matrix3d J;
  J << p.z() / fx_px, 0, -p.x() * inverse_d,  //
      0, p.z() / fy_px, -p.y() * inverse_d,   //
      0, 0, -p.z() * inverse_d;
  return J;
}

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
                "how far the focal lengths may be off, as a share: standard deviation, part of most covariances; 0 "
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
