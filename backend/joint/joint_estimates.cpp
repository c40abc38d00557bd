/// The part of JointGraph that tells where objects are and how they move, and how surely.

#include <array>
#include <cmath>

#include "backend/joint/joint_graph.hpp"
#include "backend/window/acceleration_span.hpp"
#include "core/constant_twist.hpp"
#include "core/fixed_product.hpp"

namespace motorcade {
namespace {

/// The graph takes acceleration as white noise, which makes three quarters of a twist's variance at least and the
/// measurements the rest: smoothed along positions of any noise, a velocity's error has the spectrum
/// u^6 / (1 + u^4)^2 of the acceleration and u^2 / (1 + u^4)^2 of the positions, whose integrals are as 3 to 1, and
/// the newest one of a filter has the same parts. A mean acceleration has the walk's variance in place of the former.
constexpr double kMeasuredShare = 0.25;

/// The Jacobian of the pose with the axes of travel, exp(xi) R_z(yaw + dyaw) R_y(pitch + dpitch), right perturbation.
Eigen::Matrix<double, 6, 15> byTravel(const Eigen::Matrix3d& R_body_travel) {
  Eigen::Matrix<double, 6, 15> J = Eigen::Matrix<double, 6, 15>::Zero();
  J.block<3, 3>(0, 0) = J.block<3, 3>(3, 3) = R_body_travel.transpose();
  J.block<3, 1>(3, 13) = R_body_travel.row(2).transpose();  // about the body's z axis
  J(4, 14) = 1;                                             // about the turned y axis
  return J;
}

/// The covariance of R_cam_body * v_body, both perturbed: R (dv - [v] x phi).
Eigen::Matrix3d velocityCovariance(const SE3& T_cam_body, const Eigen::Vector3d& velocity_body_mps,
                                   const Eigen::Matrix<double, 12, 12>& joint) {
  Eigen::Matrix<double, 3, 12> J = Eigen::Matrix<double, 3, 12>::Zero();
  J.middleCols<3>(3) = -T_cam_body.rotation() * hat(velocity_body_mps);
  J.middleCols<3>(6) = T_cam_body.rotation();
  return fixedProduct(J, joint).lazyProduct(J.transpose());
}

}  // namespace

SE3 JointGraph::objectPose(const ObjectTrack& track, FrameId frame) const {
  const ObjectRecord& record = track.records.at(frame);
  if (record.frozen) return *record.frozen;
  const SE3 T_cam_body = record.pose.valid()
                             ? solver_.pose(record.pose) * SE3(objects_.travelAxes(track), Eigen::Vector3d::Zero())
                             : record.seen.T_cam_body;
  return (cameraPose(frame) * T_cam_body).normalized();
}

ObjectMotionEstimate JointGraph::objectMotion(const ObjectTrack& track, FrameId frame) const {
  const ObjectRecord& record = track.records.at(frame);
  const Eigen::Matrix3d R_world_cam = cameraPose(frame).rotation();
  if (!record.twist.valid()) return {R_world_cam * record.seen.velocity_cam_mps, 0};
  const SmallVector twist = std::get<SmallVector>(solver_.estimate(record.twist));
  return {R_world_cam * solver_.pose(record.pose).rotation() * twist.head<3>(),
          objects_.travelAxes(track).col(2).dot(twist.tail<3>())};
}

/// The pose seen from the camera is a variable. The speed is the length of the twist's velocity, the yaw rate its turn
/// about the upright axis of travel.
std::optional<ObjectCovariances> JointGraph::objectCovariances(const ObjectTrack& track, FrameId frame) const {
  constexpr double kStanding_mps = 1e-9;  // slower, there is no direction
  const auto record = track.records.find(frame);
  if (record == track.records.end() || !record->second.pose.valid()) return std::nullopt;
  const auto& [pose, twist] = std::pair(record->second.pose, record->second.twist);
  const std::array variables{pose, twist, track.shared};
  const auto joint = solver_.jointCovariance(variables);
  if (!joint) return std::nullopt;
  const Eigen::Vector3d velocity = std::get<SmallVector>(solver_.estimate(twist)).head<3>();
  const Eigen::Vector3d direction = velocity.norm() > kStanding_mps ? velocity.normalized() : Eigen::Vector3d::UnitX();
  const Eigen::Matrix<double, 15, 15> covariance = designEffect() * *joint;
  const Eigen::Matrix3d R_body_travel = objects_.travelAxes(track);
  const Eigen::Vector3d up = R_body_travel.col(2);
  const double variance = direction.dot(covariance.block<3, 3>(6, 6) * direction);
  return ObjectCovariances{
      .T_cam_body = propagated(byTravel(R_body_travel), covariance),
      .velocity_cam = velocityCovariance(solver_.pose(pose), velocity, covariance.topLeftCorner<12, 12>()),
      .speed_sigma_mps = std::sqrt(std::max(0.0, variance)),
      .yaw_rate_sigma_radps = std::sqrt(std::max(0.0, up.dot(covariance.block<3, 3>(9, 9) * up))),
      .acceleration = objectAcceleration(track, frame)};
}

/// The mean change of speed and yaw rate around the frame.
std::optional<ObjectAcceleration> JointGraph::objectAcceleration(const ObjectTrack& track, FrameId frame) const {
  const auto of_speed = accelerationSpan(track, frame, kSpeedChange.reach_s);
  const auto of_yaw_rate = accelerationSpan(track, frame, kYawRateChange.reach_s);
  if (!of_speed || !of_yaw_rate) return std::nullopt;
  const std::array twists{of_speed->from->twist, of_speed->to->twist, of_yaw_rate->from->twist, of_yaw_rate->to->twist};
  const auto twist = [&](int k) { return Vector6d(std::get<SmallVector>(solver_.estimate(twists[k]))); };
  const Eigen::Matrix3d R_body_travel = objects_.travelAxes(track);
  const bool backwards = (twist(0) + twist(1)).head<3>().dot(R_body_travel.col(0)) < 0;
  const Eigen::Vector3d along = (backwards ? -1.0 : 1.0) * R_body_travel.col(0) / of_speed->length_s();
  const Eigen::Vector3d about = R_body_travel.col(2) / of_yaw_rate->length_s();

  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(2, 24);
  J.block<1, 3>(0, 0) = -along.transpose();
  J.block<1, 3>(0, 6) = along.transpose();
  J.block<1, 3>(1, 15) = -about.transpose();
  J.block<1, 3>(1, 21) = about.transpose();
  const auto covariance = solver_.jointCovariance(twists, J);
  if (!covariance) return std::nullopt;
  const auto sigma = [&](int k, const AccelerationSpan& span, const RateChange& change) {
    const double measured = kMeasuredShare * designEffect() * (*covariance)(k, k);
    return std::sqrt(std::max(0.0, measured) + span.walkVariance(change.density));
  };
  return ObjectAcceleration{.along_mps2 = along.dot((twist(1) - twist(0)).head<3>()),
                            .along_sigma_mps2 = sigma(0, *of_speed, kSpeedChange),
                            .yaw_radps2 = about.dot((twist(3) - twist(2)).tail<3>()),
                            .yaw_sigma_radps2 = sigma(1, *of_yaw_rate, kYawRateChange)};
}

}  // namespace motorcade
