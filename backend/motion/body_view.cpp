#include "backend/motion/body_view.hpp"

namespace motorcade {
namespace {

constexpr double kLoosePosition_m = 2.0, kLooseTilt_rad = 0.03, kLooseYaw_rad = 0.15;
constexpr double kLeastDisparity_px = 0.3;  // with less, a point is at infinity

std::vector<SeenPoint> pointsOfBoth(const StereoCamera& camera, const BodyView& before, const BodyView& now,
                                    const std::function<bool(PointId)>& uses) {
  std::vector<SeenPoint> both;
  auto then = before.points.begin();
  for (const PointMeasurement& seen : now.points) {
    while (then != before.points.end() && then->point < seen.point) ++then;
    if (then == before.points.end()) break;
    if (then->point != seen.point || !uses(seen.point)) continue;
    if (const auto known = triangulate(camera, before, *then))
      both.push_back({known->p_body, known->covariance, correctedUvd_px(seen, now.disparity_offset_px),
                      seen.sigma_px.cast<double>()});
  }
  return both;
}

}  // namespace

ExpectedPose looselyExpected(const SE3& T_cam_body) {
  ExpectedPose expected{T_cam_body, {}};
  expected.sigma << kLoosePosition_m, kLoosePosition_m, kLoosePosition_m, kLooseTilt_rad, kLooseTilt_rad, kLooseYaw_rad;
  return expected;
}

Eigen::Vector3d correctedUvd_px(const PointMeasurement& measured, double disparity_offset_px) {
  return measured.uvd_px.cast<double>() + Eigen::Vector3d(0, 0, disparity_offset_px);
}

std::optional<TriangulatedPoint> triangulate(const StereoCamera& camera, const BodyView& view,
                                             const PointMeasurement& point) {
  const Eigen::Vector3d uvd_px = correctedUvd_px(point, view.disparity_offset_px);
  if (!(uvd_px.z() > kLeastDisparity_px)) return std::nullopt;
  const SE3 T_body_cam = view.T_cam_body.inverse();
  const Eigen::Matrix3d J = T_body_cam.rotation() * camera.triangulationJacobian(uvd_px);
  const Eigen::Vector3d variance_px2 = point.sigma_px.cast<double>().cwiseAbs2();
  return TriangulatedPoint{T_body_cam * camera.triangulate(uvd_px), J * variance_px2.asDiagonal() * J.transpose()};
}

/// z_before^-1 z_now = T_cam_body(before)^-1 T_cam(before)_cam(now) T_cam_b. Here b is the body as it stood before, and
/// T_cam_b its pose in the camera of now, as its points' motion carries it there.
std::optional<ObjectObservation::Motion> motionBetween(const StereoCamera& camera, const BodyView& before,
                                                       const BodyView& now, const CameraPath& path,
                                                       const std::function<bool(PointId)>& uses) {
  const auto odometry_covariance = path.covarianceSince(before.frame, now.frame);
  if (!odometry_covariance) return std::nullopt;
  const std::vector<SeenPoint> both = pointsOfBoth(camera, before, now, uses);
  if (both.size() < kLeastPoints) return std::nullopt;
  const auto fit = fitPointSet(camera, both, looselyExpected(now.T_cam_body));
  if (!fit) return std::nullopt;
  const SE3 T_cambefore_camnow = path.find(before.frame)->T_world_cam.inverse() * path.find(now.frame)->T_world_cam;
  const Matrix6d through = fit->T_cam_ref.inverse().adjoint();
  return ObjectObservation::Motion{before.frame,
                                   (before.T_cam_body.inverse() * T_cambefore_camnow * fit->T_cam_ref).normalized(),
                                   fit->covariance + through * *odometry_covariance * through.transpose()};
}

}  // namespace motorcade
