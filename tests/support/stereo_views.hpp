#pragma once

#include <optional>

#include "core/stereo_camera.hpp"
#include "frontend/geometry/stereo_pose.hpp"
#include "tests/support/noise.hpp"

namespace motorcade::test {

/// KITTI-like rig of the front-end's tests.
inline const StereoCamera kRig{720, 720, 620, 188, 0.54, 1242, 375};

/// Standard deviation of each coordinate (u, v, d) that the simulated observations have.
inline const Eigen::Vector3d kObservationSigma_px = Eigen::Vector3d::Constant(0.3);

/// An observation with noise; empty outside the image.
inline std::optional<Eigen::Vector3d> look(const Eigen::Vector3d& p_cam, Noise& noise,
                                           const Eigen::Vector3d& sigma_px = kObservationSigma_px) {
  const auto uvd = kRig.project(p_cam);
  if (!uvd || !kRig.inLeftImage(uvd->x(), uvd->y())) return std::nullopt;
  const Eigen::Vector3d seen = *uvd + noise.gaussian(sigma_px);
  if (seen.z() <= 0) return std::nullopt;
  return seen;
}

/// Covariance of a triangulated point.
inline Eigen::Matrix3d triangulationCovariance(const Eigen::Vector3d& uvd_px,
                                               const Eigen::Vector3d& sigma_px = kObservationSigma_px) {
  const Eigen::Matrix3d J = kRig.triangulationJacobian(uvd_px);
  return J * sigma_px.cwiseAbs2().asDiagonal() * J.transpose();
}

/// A point seen from two poses of the camera, triangulated in the first; empty when either does not see it.
inline std::optional<PoseObservation> lookTwice(const Eigen::Vector3d& p_before, const Eigen::Vector3d& p_now,
                                                Noise& noise) {
  const auto before = look(p_before, noise), now = look(p_now, noise);
  if (!before || !now) return std::nullopt;
  return PoseObservation{kRig.triangulate(*before), triangulationCovariance(*before), *now, kObservationSigma_px};
}

/// A point of the street, in the camera's frame: from `near_m` to `far_m` ahead, evenly over the image.
inline Eigen::Vector3d streetPoint(Noise& noise, double near_m, double far_m) {
  const double z = noise.uniform(near_m, far_m);
  return {z * noise.uniform(-0.7, 0.7), z * noise.uniform(-0.2, 0.2), z};
}

}  // namespace motorcade::test
