#include "frontend/tracked_object.hpp"

#include <algorithm>

namespace motorcade {

const BodyPoint* TrackedObject::find(PointId point) const {
  const auto at = std::lower_bound(points.begin(), points.end(), point, [](const BodyPoint& p, PointId id) { return p.point < id; });
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

Eigen::Vector3d TrackedObject::velocityAt_mps(const Eigen::Vector3d& p_body) const {
  const Vector6d& twist = kinematics.twist();
  return kinematics.pose().rotation() * (twist.head<3>() + twist.tail<3>().cross(p_body));
}

void TrackedObject::changeBodyFrame(const SE3& T_body_new) {
  const SE3 T_new_body = T_body_new.inverse();
  const Matrix6d A = T_new_body.adjoint();
  kinematics.changeBodyFrame(T_body_new);
  T_cam_body = T_cam_body * T_body_new;
  T_cam_body_before = T_cam_body_before * T_body_new;
  for (auto& p : points) {
    p.p_body = T_new_body * p.p_body;
    p.covariance = T_new_body.rotation() * p.covariance * T_new_body.rotation().transpose();
  }
  for (auto& o : backlog) {
    o.T_cam_body = o.T_cam_body * T_body_new;
    o.encounter_covariance = A * o.encounter_covariance * A.transpose();
    if (!o.motion) continue;
    o.motion->T_before_now = T_new_body * o.motion->T_before_now * T_body_new;
    o.motion->covariance = A * o.motion->covariance * A.transpose();
  }
}

}  // namespace motorcade
