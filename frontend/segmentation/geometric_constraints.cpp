#include "frontend/segmentation/geometric_constraints.hpp"

#include <algorithm>
#include <cmath>

namespace motorcade {
namespace {

constexpr double kMinLine_px = 0.05;  // shorter stretches of the epipolar line have no direction

/// Where the point of `uv_then` with disparity d appears now.
std::optional<Eigen::Vector2d> transfer(const StereoCamera& camera, const Eigen::Vector3d& uvd_then_px,
                                        double disparity_px, const SE3& T_now_then) {
  const auto uvd = camera.project(T_now_then * camera.triangulate({uvd_then_px.x(), uvd_then_px.y(), disparity_px}));
  if (!uvd) return std::nullopt;
  return uvd->head<2>();
}

}  // namespace

std::optional<GeometricResidual> geometricResidual(const StereoCamera& camera, const Eigen::Vector3d& uvd_then_px,
                                                   const Eigen::Vector3d& sigma_then_px,
                                                   const Eigen::Vector2d& uv_now_px, double sigma_now_px,
                                                   const SE3& T_now_then, double depth_sigmas) {
  constexpr double kNearlyInfinite_px = 0.05;  // disparity of a point some kilometers away
  const double spread = depth_sigmas * sigma_then_px.z();
  const auto far = transfer(camera, uvd_then_px, std::max(kNearlyInfinite_px, uvd_then_px.z() - spread), T_now_then);
  const auto near = transfer(camera, uvd_then_px, uvd_then_px.z() + spread, T_now_then);
  if (!far || !near) return std::nullopt;
  const double length = (*near - *far).norm();
  if (length < kMinLine_px) return std::nullopt;

  const Eigen::Vector2d along = (*near - *far) / length, offset = uv_now_px - *far;
  const double sigma_px = std::hypot(sigma_now_px, sigma_then_px.x());
  GeometricResidual residual;
  residual.epipolar_sigmas = std::abs(along.x() * offset.y() - along.y() * offset.x()) / sigma_px;
  const double s = along.dot(offset);
  residual.flow_bound_px = std::max({0.0, -s - depth_sigmas * sigma_px, s - length - depth_sigmas * sigma_px});
  return residual;
}

}  // namespace motorcade
