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

}  // namespace motorcade
