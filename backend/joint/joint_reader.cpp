#include "backend/joint/joint_reader.hpp"

#include <array>
#include <cmath>
#include <iterator>

#include "core/constant_twist.hpp"
#include "core/fixed_product.hpp"

namespace motorcade {
namespace {

using Matrix6x12d = Eigen::Matrix<double, 6, 12>;

/// Of the pose's axes after those of travel: exp(xi) R_z(yaw + dyaw) R_y(pitch + dpitch), right perturbation.
Eigen::Matrix<double, 6, 15> byTravel(const Eigen::Matrix3d& R_body_travel) {
  Eigen::Matrix<double, 6, 15> J = Eigen::Matrix<double, 6, 15>::Zero();
  J.block<3, 3>(0, 0) = J.block<3, 3>(3, 3) = R_body_travel.transpose();
  J.block<3, 1>(3, 13) = R_body_travel.row(2).transpose();  // about the body's z axis
  J(4, 14) = 1;                                             // about the turned y axis
  return J;
}

/// Of R_cam_body * v_body, both perturbed: R (dv - [v] x phi).
Eigen::Matrix3d velocityCovariance(const SE3& T_cam_body, const Eigen::Vector3d& velocity_body_mps,
                                   const Eigen::Matrix<double, 12, 12>& joint) {
  Eigen::Matrix<double, 3, 12> J = Eigen::Matrix<double, 3, 12>::Zero();
  J.middleCols<3>(3) = -T_cam_body.rotation() * hat(velocity_body_mps);
  J.middleCols<3>(6) = T_cam_body.rotation();
  return fixedProduct(J, joint).lazyProduct(J.transpose());
}

}  // namespace

JointCovariances JointReader::covariances(FrameId frame) const {
  JointCovariances covariances{.camera = cameraCovariance(frame), .objects = {}};
  for (const auto& [id, object] : graph_.objects()) {
    const auto record = object.records.find(frame);
    if (record == object.records.end()) continue;
    if (const auto covariance = objectCovariance(id, object, record->second))
      covariances.objects.push_back(*covariance);
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
  const Matrix6x12d scaled = graph_.designEffect() * J;
  const Eigen::Matrix<double, 12, 6> J_T = J.transpose();
  return fixedProduct(fixedProduct(scaled, Matrix12d(*joint)), J_T);
}

/// Of the pose seen from the camera, which is a variable, of the speed, the length of the twist's velocity, and of its
/// turn about the body's z axis.
std::optional<JointCovariances::Object> JointReader::objectCovariance(TrackId id, const JointObject& object,
                                                                      const JointRecord& record) const {
  constexpr double kStanding_mps = 1e-9;  // slower, there is no direction
  if (!record.c.valid()) return std::nullopt;
  const std::array variables{record.c, record.w, object.travel};
  const auto joint = graph_.solver().jointCovariance(variables);
  if (!joint) return std::nullopt;
  const Eigen::Vector3d velocity = std::get<SmallVector>(graph_.solver().estimate(record.w)).head<3>();
  const Eigen::Vector3d direction = velocity.norm() > kStanding_mps ? velocity.normalized() : Eigen::Vector3d::UnitX();
  const Eigen::Matrix<double, 15, 15> covariance = graph_.designEffect() * *joint;
  const Eigen::Matrix3d R_body_travel = graph_.travelAxes(object);
  const Eigen::Vector3d up = R_body_travel.col(2);
  const Eigen::Matrix<double, 6, 15> by_travel = byTravel(R_body_travel);
  const double variance = direction.dot(covariance.block<3, 3>(6, 6) * direction);
  return JointCovariances::Object{
      .track = id,
      .T_cam_body = propagated(by_travel, covariance),
      .velocity_cam = velocityCovariance(graph_.solver().pose(record.c), velocity, covariance.topLeftCorner<12, 12>()),
      .speed_sigma_mps = std::sqrt(std::max(0.0, variance)),
      .yaw_rate_sigma_radps = std::sqrt(std::max(0.0, up.dot(covariance.block<3, 3>(9, 9) * up)))};
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
  const double yaw_rate_radps = graph_.yawRate_radps(object, frame);
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
