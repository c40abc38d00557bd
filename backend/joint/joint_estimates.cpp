/// Estimates of objects by JointGraph: where they are, how they move, and how surely.

#include <array>
#include <cmath>
#include <vector>

#include "backend/joint/joint_graph.hpp"
#include "backend/window/acceleration_span.hpp"
#include "core/constant_twist.hpp"
#include "core/fixed_product.hpp"

namespace motorcade {
namespace {

/// Share of the measurements in a twist's variance, where a mean acceleration has the walk's variance in place of the
/// rest. The graph takes acceleration as white noise. Smoothed along positions of any noise, a velocity's error has the
/// spectrum u^6 / (1 + u^4)^2 of the acceleration and u^2 / (1 + u^4)^2 of the positions. Their integrals are as 3 to
/// 1, and the newest velocity of a filter has the same parts.
constexpr double kMeasuredShare = 0.25;

/// Jacobian of the pose with the axes of travel, exp(xi) R_z(yaw + dyaw) R_y(pitch + dpitch), right perturbation, with
/// respect to pose, twist, yaw and pitch.
Eigen::Matrix<double, 6, 14> byTravel(const Eigen::Matrix3d& R_body_travel) {
  Eigen::Matrix<double, 6, 14> J = Eigen::Matrix<double, 6, 14>::Zero();
  J.block<3, 3>(0, 0) = J.block<3, 3>(3, 3) = R_body_travel.transpose();
  J.block<3, 1>(3, 12) = R_body_travel.row(2).transpose();  // about the body's z axis
  J(4, 13) = 1;                                             // about the turned y axis
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

/// Mean changes of speed and yaw rate around a frame, as they follow from the twists at the ends of two spans.
struct JointGraph::TwistChanges {
  AccelerationSpan of_speed, of_yaw_rate;
  Eigen::Vector3d along, about;  // body axes
  std::array<Vector6d, 4> twists;

  std::array<VariableId, 4> variables() const {
    return {of_speed.from->twist, of_speed.to->twist, of_yaw_rate.from->twist, of_yaw_rate.to->twist};
  }
  /// Jacobian of the two changes with respect to the four twists.
  Eigen::Matrix<double, 2, 24> jacobian() const {
    Eigen::Matrix<double, 2, 24> J = Eigen::Matrix<double, 2, 24>::Zero();
    J.block<1, 3>(0, 0) = -along.transpose() / of_speed.length_s();
    J.block<1, 3>(0, 6) = along.transpose() / of_speed.length_s();
    J.block<1, 3>(1, 15) = -about.transpose() / of_yaw_rate.length_s();
    J.block<1, 3>(1, 21) = about.transpose() / of_yaw_rate.length_s();
    return J;
  }
  /// Acceleration from `covariance`, the graph's of the two changes, and `density`, that of its white noise on
  /// acceleration. At the end of an object's frames the noise prior draws the mean change towards zero, by the share
  /// that is left of the variance before any measurement, density / length.
  ObjectAcceleration acceleration(const Eigen::Matrix2d& covariance, const Vector6d& density) const {
    const auto sigma = [&](int k, const AccelerationSpan& span, const RateChange& change) {
      const double variance = std::max(0.0, covariance(k, k));
      const double drawn = span.at_end ? std::min(1.0, variance * span.length_s() / density[k == 0 ? 0 : 5]) : 0;
      return std::sqrt(kMeasuredShare * variance + span.walkVariance(change.density()) +
                       std::pow(drawn * change.deviation, 2));
    };
    return {.along_mps2 = along.dot((twists[1] - twists[0]).head<3>()) / of_speed.length_s(),
            .along_sigma_mps2 = sigma(0, of_speed, kSpeedChange),
            .yaw_radps2 = about.dot((twists[3] - twists[2]).tail<3>()) / of_yaw_rate.length_s(),
            .yaw_sigma_radps2 = sigma(1, of_yaw_rate, kYawRateChange)};
  }
};

std::optional<JointGraph::TwistChanges> JointGraph::twistChanges(const ObjectTrack& track, FrameId frame) const {
  const auto of_speed = accelerationSpan(track, frame, kSpeedChange.reach_s);
  const auto of_yaw_rate = accelerationSpan(track, frame, kYawRateChange.reach_s);
  if (!of_speed || !of_yaw_rate) return std::nullopt;
  const Eigen::Matrix3d R_body_travel = objects_.travelAxes(track);
  TwistChanges changes{.of_speed = *of_speed,
                       .of_yaw_rate = *of_yaw_rate,
                       .along = R_body_travel.col(0),
                       .about = R_body_travel.col(2),
                       .twists = {}};
  const auto variables = changes.variables();
  for (std::size_t k = 0; k < variables.size(); ++k)
    changes.twists[k] = std::get<SmallVector>(solver_.estimate(variables[k]));
  const bool backwards = (changes.twists[0] + changes.twists[1]).head<3>().dot(changes.along) < 0;
  if (backwards) changes.along = -changes.along;
  return changes;
}

/// Covariance of the changes, where there are some, and of pose, twist, yaw and pitch of the axes of travel.
std::optional<Eigen::MatrixXd> JointGraph::motionCovariance(const ObjectTrack& track, const ObjectRecord& record,
                                                            const std::optional<TwistChanges>& changes) const {
  std::vector<VariableId> variables{record.pose, record.twist, track.shared};
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(changes ? 16 : 14, changes ? 39 : 15);
  auto J_motion = J.bottomRows<14>();
  J_motion.topLeftCorner<12, 12>().setIdentity();
  J_motion(12, 13) = J_motion(13, 14) = 1;
  if (changes) {
    for (const VariableId twist : changes->variables()) variables.push_back(twist);
    J.topRightCorner<2, 24>() = changes->jacobian();
  }
  auto covariance = solver_.jointCovariance(variables, J);
  if (covariance) *covariance *= designEffect();
  return covariance;
}

/// The pose seen from the camera is a variable. The speed is the length of the twist's velocity, the yaw rate its turn
/// about the upright axis of travel.
std::optional<ObjectCovariances> JointGraph::objectCovariances(const ObjectTrack& track, FrameId frame) const {
  constexpr double kStanding_mps = 1e-9;  // slower, there is no direction
  const auto record = track.records.find(frame);
  if (record == track.records.end() || !record->second.pose.valid()) return std::nullopt;
  const auto& [pose, twist] = std::pair(record->second.pose, record->second.twist);
  const auto changes = twistChanges(track, frame);
  const auto joint = motionCovariance(track, record->second, changes);
  if (!joint) return std::nullopt;
  const Eigen::Vector3d velocity = std::get<SmallVector>(solver_.estimate(twist)).head<3>();
  const Eigen::Vector3d direction = velocity.norm() > kStanding_mps ? velocity.normalized() : Eigen::Vector3d::UnitX();
  const Eigen::Matrix<double, 14, 14> covariance = joint->bottomRightCorner<14, 14>();
  const Eigen::Matrix3d R_body_travel = objects_.travelAxes(track);
  const Eigen::Vector3d up = R_body_travel.col(2);
  const double variance = direction.dot(covariance.block<3, 3>(6, 6) * direction);
  ObjectCovariances known{
      .T_cam_body = propagated(byTravel(R_body_travel), covariance),
      .velocity_cam = velocityCovariance(solver_.pose(pose), velocity, covariance.topLeftCorner<12, 12>()),
      .speed_sigma_mps = std::sqrt(std::max(0.0, variance)),
      .yaw_rate_sigma_radps = std::sqrt(std::max(0.0, up.dot(covariance.block<3, 3>(9, 9) * up))),
      .acceleration = {}};
  if (changes) known.acceleration = changes->acceleration(joint->topLeftCorner<2, 2>(), params_.acceleration.density());
  return known;
}

}  // namespace motorcade
