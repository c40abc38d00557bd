#include "frontend/segmentation/geometric_constraints.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "core/elementary.hpp"
#include "frontend/motion/shared_velocity_error.hpp"

namespace motorcade {
namespace {

constexpr double kMinLine_px = 0.05;         // shorter stretches of the epipolar line have no direction
constexpr double kNearlyInfinite_px = 0.05;  // disparity of a point some kilometers away
constexpr double kDepthSigmas = 3.0;         // of depth and of position along the line: 99.7 %
constexpr int kMinObservations = 3;          // of a track: between two neighboring frames lines are short
constexpr double kMaxEpipolarSigmas = 4;     // one of 15,000 points at rest exceeds it by noise
constexpr double kMaxFlowBound_px = 2;       // beyond the noise: room for errors of the camera's motion
constexpr double kMaxRestChi2 = 16.3;        // of a velocity, 3 degrees of freedom: 99.9 %

/// Image position now of the point of `uvd_then_px`, with another disparity.
std::optional<Eigen::Vector2d> transfer(const StereoCamera& camera, const Eigen::Vector3d& uvd_then_px,
                                        double disparity_px, const SE3& T_now_then) {
  const auto uvd = camera.project(T_now_then * camera.triangulate({uvd_then_px.x(), uvd_then_px.y(), disparity_px}));
  if (!uvd) return std::nullopt;
  return uvd->head<2>();
}

}  // namespace

std::optional<GeometricResidual> geometricResidual(const StereoCamera& camera, const StereoCorrespondence& point,
                                                   const SE3& T_now_then) {
  const Eigen::Vector3d& uvd_then_px = point.uvd_then_px;
  const double spread = kDepthSigmas * point.sigma_then_px.z();
  const auto far = transfer(camera, uvd_then_px, std::max(kNearlyInfinite_px, uvd_then_px.z() - spread), T_now_then);
  const auto near = transfer(camera, uvd_then_px, uvd_then_px.z() + spread, T_now_then);
  if (!far || !near) return std::nullopt;
  const double length = (*near - *far).norm();
  if (length < kMinLine_px) return std::nullopt;

  const Eigen::Vector2d along = (*near - *far) / length, offset = point.uvd_now_px.head<2>() - *far;
  const double sigma_px = hypotenuse(point.sigma_now_px.x(), point.sigma_then_px.x());
  GeometricResidual residual;
  residual.epipolar_sigmas = std::abs(along.x() * offset.y() - along.y() * offset.x()) / sigma_px;
  const double s = along.dot(offset);
  residual.flow_bound_px = std::max({0.0, -s - kDepthSigmas * sigma_px, s - length - kDepthSigmas * sigma_px});
  return residual;
}

/// Judges over the longest stretch of the track, where the epipolar line is longest.
bool violatesGeometry(const StereoCamera& camera, const PointTrack& track, const CameraTrail& trail) {
  if (track.count < kMinObservations) return false;
  const auto* relation = trail.find(track.oldest().step);
  if (!relation) return false;
  const auto residual = geometricResidual(camera, track.sinceThen(track.oldest()), relation->T_then_now.inverse());
  return residual && (residual->epipolar_sigmas > kMaxEpipolarSigmas || residual->flow_bound_px > kMaxFlowBound_px);
}

bool movesSurely(const StereoCamera& camera, const SceneFlow& flow, double camera_speed_mps) {
  const Eigen::Matrix3d C =
      flow.covariance.bottomRightCorner<3, 3>() + sharedVelocityCovariance(camera, flow.p_cam, camera_speed_mps);
  return flow.velocity_mps.dot(C.inverse() * flow.velocity_mps) > kMaxRestChi2;
}

}  // namespace motorcade
