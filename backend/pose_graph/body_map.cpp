#include "backend/pose_graph/body_map.hpp"

#include <Eigen/LU>

namespace motorcade {
namespace {

constexpr int kFramesWithoutView = 5;  // without a view

using Matrix3x6d = Eigen::Matrix<double, 3, 6>;

/// d(T exp(xi) p) / d(xi), in the body's axes.
Matrix3x6d byPose(const Eigen::Vector3d& p_body) {
  Matrix3x6d J;
  J << Eigen::Matrix3d::Identity(), -hat(p_body);
  return J;
}

/// Corrects a point by a Kalman step; the error of the view's pose counts as part of the measurement's.
void correct(TriangulatedPoint& p, const StereoCamera& camera, const SE3& T_cam_body, const Matrix6d& pose_covariance,
             const Eigen::Vector3d& uvd_px, const Eigen::Vector3d& sigma_px) {
  const Eigen::Vector3d p_cam = T_cam_body * p.p_body;
  const auto predicted = camera.project(p_cam);
  if (!predicted) return;
  const Eigen::Matrix3d J = camera.projectionJacobian(p_cam) * T_cam_body.rotation();
  const Matrix3x6d J_pose = J * byPose(p.p_body);
  Eigen::Matrix3d S = J * p.covariance * J.transpose() + J_pose * pose_covariance * J_pose.transpose();
  S.diagonal() += sigma_px.cwiseAbs2();
  const Eigen::Matrix3d K = p.covariance * J.transpose() * S.inverse();
  p.p_body += K * (uvd_px - *predicted);
  const Eigen::Matrix3d C = p.covariance - K * J * p.covariance;
  p.covariance = 0.5 * (C + C.transpose());
}

}  // namespace

std::vector<SeenPoint> BodyMap::seenIn(const BodyView& view, const std::function<bool(PointId)>& uses) const {
  std::vector<SeenPoint> seen;
  for (const PointMeasurement& now : view.points) {
    const auto known = points_.find(now.point);
    if (known == points_.end() || !uses(now.point)) continue;
    seen.push_back({known->second.point.p_body, known->second.point.covariance,
                    correctedUvd_px(now, view.disparity_offset_px), now.sigma_px.cast<double>()});
  }
  return seen;
}

void BodyMap::update(const StereoCamera& camera, const BodyView& view, const Matrix6d& pose_covariance) {
  for (const PointMeasurement& now : view.points) {
    const auto known = points_.find(now.point);
    if (known != points_.end()) {
      known->second.last_seen = view.frame;
      correct(known->second.point, camera, view.T_cam_body, pose_covariance,
              correctedUvd_px(now, view.disparity_offset_px), now.sigma_px.cast<double>());
    } else if (auto point = triangulate(camera, view, now)) {
      const Matrix3x6d J = byPose(point->p_body);
      point->covariance += J * pose_covariance * J.transpose();
      points_[now.point] = {*point, view.frame};
    }
  }
  std::erase_if(points_,
                [&](const auto& p) { return view.frame.value - p.second.last_seen.value > kFramesWithoutView; });
}

}  // namespace motorcade
