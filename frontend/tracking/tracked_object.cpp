#include "frontend/tracking/tracked_object.hpp"

#include <algorithm>

#include <Eigen/LU>

namespace motorcade {

void BodyPoint::moveTo(const SE3& T_new_old) {
  p_body = T_new_old * p_body;
  covariance = T_new_old.rotation() * covariance * T_new_old.rotation().transpose();
}

BodyPoint toBody(const ScenePoint& point, const SE3& T_cam_body, const StereoCamera& camera) {
  const SE3 T_body_cam = T_cam_body.inverse();
  const Eigen::Matrix3d J = T_body_cam.rotation() * camera.triangulationJacobian(point.uvd_px);
  return {point.point, T_body_cam * camera.triangulate(point.uvd_px),
          J * point.sigma_px.cwiseAbs2().asDiagonal() * J.transpose()};
}

const BodyPoint* TrackedObject::find(PointId point) const {
  const auto at = std::lower_bound(points.begin(), points.end(), point,
                                   [](const BodyPoint& p, PointId id) { return p.point < id; });
  return at != points.end() && at->point == point ? &*at : nullptr;
}

void TrackedObject::adopt(const std::vector<BodyPoint>& more) {
  points.insert(points.end(), more.begin(), more.end());
  std::sort(points.begin(), points.end(), [](const BodyPoint& a, const BodyPoint& b) { return a.point < b.point; });
}

Eigen::AlignedBox3d TrackedObject::extent(double margin_m) const {
  Eigen::AlignedBox3d box(Eigen::Vector3d::Zero());
  for (const auto& p : points) box.extend(p.p_body);
  box.min().array() -= margin_m;
  box.max().array() += margin_m;
  return box;
}

Eigen::AlignedBox3d TrackedObject::core(const SE3& T, double left_out) const {
  Eigen::AlignedBox3d box;
  const auto outliers =
      static_cast<std::size_t>(left_out * static_cast<double>(points.empty() ? 0 : points.size() - 1));
  std::vector<double> values(points.size());
  for (int axis = 0; axis < 3 && !points.empty(); ++axis) {
    std::transform(points.begin(), points.end(), values.begin(),
                   [&](const BodyPoint& p) { return (T * p.p_body)[axis]; });
    std::sort(values.begin(), values.end());
    box.min()[axis] = values[outliers];
    box.max()[axis] = values[values.size() - 1 - outliers];
  }
  return box;
}

Eigen::Vector3d TrackedObject::middle() const {
  const Eigen::AlignedBox3d half = core(SE3{}, 0.5);
  return half.isEmpty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(half.center());
}

Eigen::Vector3d TrackedObject::velocityAt_mps(const Eigen::Vector3d& p_body) const {
  const Vector6d& twist = kinematics.twist();
  return kinematics.pose().rotation() * (twist.head<3>() + twist.tail<3>().cross(p_body));
}

bool TrackedObject::carries(const SceneFlow& flow, const SE3& T_world_cam) const {
  constexpr double kMaxChi2 = 9.0;         // 3 degrees of freedom: 97 %
  constexpr double kModelSigma_mps = 0.5;  // a few points' velocities depart from a rigid body's: wheels, wrong matches
  const Eigen::Matrix3d &R = T_world_cam.rotation(), &R_body = kinematics.pose().rotation();
  const Eigen::Vector3d difference = R * flow.velocity_mps - velocityAt_mps(T_cam_body.inverse() * flow.p_cam);
  const Eigen::Matrix3d S = R * flow.covariance.bottomRightCorner<3, 3>() * R.transpose() +
                            R_body * kinematics.velocityCovariance() * R_body.transpose() +
                            kModelSigma_mps * kModelSigma_mps * Eigen::Matrix3d::Identity();
  return difference.dot(S.inverse() * difference) < kMaxChi2;
}

void TrackedObject::changeBodyFrame(const SE3& T_body_new) {
  const SE3 T_new_body = T_body_new.inverse();
  const Matrix6d A = T_new_body.adjoint();
  kinematics.changeBodyFrame(T_body_new);
  T_cam_body = T_cam_body * T_body_new;
  for (BodyPoint& p : points) p.moveTo(T_new_body);
  for (auto& o : backlog) {
    o.T_cam_body = o.T_cam_body * T_body_new;
    o.encounter_covariance = A * o.encounter_covariance * A.transpose();
  }
}

}  // namespace motorcade
