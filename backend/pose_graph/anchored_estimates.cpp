/// Estimates of objects by AnchoredPoseGraph: how they move, and how surely.

#include <algorithm>
#include <cmath>
#include <iterator>

#include "backend/pose_graph/anchored_pose_graph.hpp"
#include "core/fixed_product.hpp"

namespace motorcade {
namespace {

using Matrix6x12d = Eigen::Matrix<double, 6, 12>;
using Matrix6x18d = Eigen::Matrix<double, 6, 18>;
using Matrix12d = Eigen::Matrix<double, 12, 12>;
using Matrix18d = Eigen::Matrix<double, 18, 18>;

/// Twist in the body's axes between two poses [m/s, rad/s].
Vector6d twist(const SE3& T_world_before, const SE3& T_world_after, double dt_s) {
  return (T_world_before.inverse() * T_world_after).log() / dt_s;
}

/// Returns the object's pose before a frame, else the one after it; null when the graph has neither.
const ObjectRecord* neighborInTime(const ObjectTrack& track, FrameId frame) {
  const auto now = track.records.find(frame);
  if (now != track.records.begin() && std::prev(now)->second.pose.valid()) return &std::prev(now)->second;
  if (std::next(now) != track.records.end() && std::next(now)->second.pose.valid()) return &std::next(now)->second;
  return nullptr;
}

/// Adds the deviations of the speed |rho| / dt and the yaw rate phi_z / dt with (rho, phi) = log(z_other^-1 z_now),
/// from the joint covariance of (z_now, z_other).
void addRateSigmas(ObjectCovariances& object, const SE3& T_other_now, const Eigen::Ref<const Matrix12d>& joint,
                   double dt_s) {
  if (!(dt_s > 0)) return;
  constexpr double kShortestStep_m = 1e-9;  // a shorter one has no direction
  const Vector6d step = T_other_now.log();
  const Matrix6d J_now = rightJacobianInverseSE3(step);
  Matrix6x12d J_step;
  J_step << J_now, -J_now * T_other_now.inverse().adjoint();
  const Matrix6d covariance = propagated(J_step, Matrix12d(joint));
  const double length_m = step.head<3>().norm();
  const Eigen::Vector3d direction =
      length_m > kShortestStep_m ? Eigen::Vector3d(step.head<3>() / length_m) : Eigen::Vector3d::UnitX();
  object.speed_sigma_mps = std::sqrt(direction.dot(covariance.topLeftCorner<3, 3>() * direction)) / dt_s;
  object.yaw_rate_sigma_radps = std::sqrt(std::max(0.0, covariance(5, 5))) / dt_s;
}

}  // namespace

SE3 AnchoredPoseGraph::objectPose(const ObjectTrack& track, FrameId frame) const {
  const ObjectRecord& record = track.records.at(frame);
  if (record.frozen) return *record.frozen;
  if (record.pose.valid()) return (solver_.pose(track.shared) * solver_.pose(record.pose)).normalized();
  return (cameraPose(frame) * record.seen.T_cam_body).normalized();
}

ObjectMotionEstimate AnchoredPoseGraph::objectMotion(const ObjectTrack& track, FrameId frame) const {
  const auto twist = meanTwist(track, frame);
  if (!twist) return {cameraPose(frame).rotation() * track.records.at(frame).seen.velocity_cam_mps, 0};
  return {objectPose(track, frame).rotation() * twist->head<3>(), (*twist)[5]};
}

/// Mean of the body twists to the poses before and after, as far as there are any. It is exact on arcs of constant
/// speed.
std::optional<Vector6d> AnchoredPoseGraph::meanTwist(const ObjectTrack& track, FrameId frame) const {
  const auto now = track.records.find(frame);
  Vector6d sum = Vector6d::Zero();
  int count = 0;
  const auto add = [&](const auto& before, const auto& after) {
    const double dt_s = secondsBetween(before->second.stamp, after->second.stamp);
    if (!(dt_s > 0)) return;
    sum += twist(objectPose(track, before->first), objectPose(track, after->first), dt_s);
    ++count;
  };
  if (now != track.records.begin()) add(std::prev(now), now);
  if (std::next(now) != track.records.end()) add(now, std::next(now));
  if (count == 0) return std::nullopt;
  return sum / count;
}

std::optional<ObjectCovariances> AnchoredPoseGraph::objectCovariances(const ObjectTrack& track, FrameId frame) const {
  const auto record = track.records.find(frame);
  if (record == track.records.end() || !record->second.pose.valid()) return std::nullopt;
  const VariableId x = frames_.at(frame).x;
  const ObjectRecord* other = neighborInTime(track, frame);
  std::vector<VariableId> variables{x, track.shared, record->second.pose};
  if (other) variables.push_back(other->pose);
  const auto joint = solver_.jointCovariance(variables);
  if (!joint) return std::nullopt;

  // x^-1 a z: exp(-Ad(T_body_cam) xi_x + Ad(z^-1) xi_a + xi_z)
  const SE3 z = solver_.pose(record->second.pose);
  const SE3 T_body_cam = (solver_.pose(track.shared) * z).inverse() * solver_.pose(x);
  Matrix6x18d J;
  J << -T_body_cam.adjoint(), z.inverse().adjoint(), Matrix6d::Identity();
  ObjectCovariances object{.T_cam_body = propagated(J, Matrix18d(joint->topLeftCorner<18, 18>())),
                           .velocity_cam = {},
                           .speed_sigma_mps = {},
                           .yaw_rate_sigma_radps = {},
                           .acceleration = {}};
  if (other)
    addRateSigmas(object, solver_.pose(other->pose).inverse() * z, joint->bottomRightCorner<12, 12>(),
                  std::abs(secondsBetween(other->stamp, record->second.stamp)));
  return object;
}

}  // namespace motorcade
