#include "backend/joint/joint_reader.hpp"

#include <array>
#include <cmath>
#include <iterator>

#include "core/constant_twist.hpp"

namespace motorcade {
namespace {

using Matrix6x12d = Eigen::Matrix<double, 6, 12>;

/// Of R_cam_body * v_body, both perturbed: R (dv - [v] x phi).
Eigen::Matrix3d velocityCovariance(const SE3& T_cam_body, const Eigen::Vector3d& velocity_body_mps,
                                   const Eigen::Matrix<double, 12, 12>& joint) {
  Eigen::Matrix<double, 3, 12> J = Eigen::Matrix<double, 3, 12>::Zero();
  J.middleCols<3>(3) = -T_cam_body.rotation() * hat(velocity_body_mps);
  J.middleCols<3>(6) = T_cam_body.rotation();
  return J * joint * J.transpose();
}

}  // namespace

JointCovariances JointReader::covariances(FrameId frame) const {
  JointCovariances covariances{.camera = cameraCovariance(frame), .objects = {}};
  for (const auto& [id, object] : graph_.objects()) {
    const auto record = object.records.find(frame);
    if (record == object.records.end()) continue;
    if (const auto covariance = objectCovariance(id, record->second)) covariances.objects.push_back(*covariance);
  }
  return covariances;
}

std::optional<Matrix6d> JointReader::cameraCovariance(FrameId frame) const {
  const auto now = graph_.frames().find(frame),
             after = graph_.frames().upper_bound(FrameId{frame.value - kCameraCovarianceFrames});
  if (after == graph_.frames().begin()) return std::nullopt;
  const auto before = std::prev(after);
  if (before->second.gauge != now->second.gauge) return std::nullopt;
  const std::array variables{before->second.x, now->second.x};
  const auto joint = graph_.solver().jointCovariance(variables);
  if (!joint) return std::nullopt;
  // x_b^-1 x_n with both perturbed: exp(-Ad(T_n_b) xi_b + xi_n)
  const SE3 T_before_now = graph_.solver().pose(before->second.x).inverse() * graph_.solver().pose(now->second.x);
  Matrix6x12d J;
  J << -T_before_now.inverse().adjoint(), Matrix6d::Identity();
  return graph_.designEffect() * J * *joint * J.transpose();
}

/// Of the pose seen from the camera, which is a variable, of the speed, the length of the twist's velocity, and of its
/// turn about the body's z axis.
std::optional<JointCovariances::Object> JointReader::objectCovariance(TrackId id, const JointRecord& record) const {
  constexpr double kStanding_mps = 1e-9;  // slower, there is no direction
  if (!record.c.valid()) return std::nullopt;
  const std::array variables{record.c, record.w};
  const auto joint = graph_.solver().jointCovariance(variables);
  if (!joint) return std::nullopt;
  const Eigen::Vector3d velocity = std::get<SmallVector>(graph_.solver().estimate(record.w)).head<3>();
  const Eigen::Vector3d direction = velocity.norm() > kStanding_mps ? velocity.normalized() : Eigen::Vector3d::UnitX();
  const Eigen::Matrix<double, 12, 12> covariance = graph_.designEffect() * *joint;
  const double variance = direction.dot(covariance.block<3, 3>(6, 6) * direction);
  return JointCovariances::Object{
      .track = id,
      .T_cam_body = covariance.topLeftCorner<6, 6>(),
      .velocity_cam = velocityCovariance(graph_.solver().pose(record.c), velocity, covariance),
      .speed_sigma_mps = std::sqrt(std::max(0.0, variance)),
      .yaw_rate_sigma_radps = std::sqrt(std::max(0.0, covariance(11, 11)))};
}

FrameEstimate JointReader::read(FrameId frame) const {
  const JointCamera& camera = graph_.frames().at(frame);
  FrameEstimate estimate{.frame = frame,
                         .stamp = camera.stamp,
                         .status = camera.status,
                         .T_world_cam = graph_.solver().pose(camera.x).normalized(),
                         .camera_covariance = camera.covariance,
                         .objects = {}};
  for (const auto& [id, object] : graph_.objects())
    if (object.records.contains(frame)) estimate.objects.push_back(readObject(id, object, frame));
  return estimate;
}

ObjectEstimate JointReader::readObject(TrackId id, const JointObject& object, FrameId frame) const {
  constexpr double kUnknownSpeedSigma_mps = 10.0, kUnknownYawRateSigma_radps = 0.3;  // of a single observation
  const JointRecord& record = object.records.at(frame);
  const double yaw_rate_radps = record.w.valid() ? std::get<SmallVector>(graph_.solver().estimate(record.w))[5] : 0;
  const Eigen::Matrix3d R_world_cam = graph_.solver().pose(graph_.frames().at(frame).x).rotation();
  std::optional<Eigen::Matrix3d> velocity_covariance;
  if (record.velocity_cam_covariance)
    velocity_covariance = R_world_cam * *record.velocity_cam_covariance * R_world_cam.transpose();
  return {.track = id,
          .state = record.seen.state,
          .T_world_body = graph_.objectPose(object, frame),
          .velocity_world_mps = graph_.objectVelocity_mps(object, frame),
          .speed_sigma_mps = record.speed_sigma_mps.value_or(kUnknownSpeedSigma_mps),
          .velocity_covariance = velocity_covariance,
          .yaw_rate_radps = yaw_rate_radps,
          .yaw_rate_sigma_radps = record.yaw_rate_sigma_radps.value_or(kUnknownYawRateSigma_radps),
          .points = record.seen.points,
          .box = record.seen.box,
          .covariance = record.covariance};
}

}  // namespace motorcade
