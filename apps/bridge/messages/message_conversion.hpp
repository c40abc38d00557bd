#pragma once

#include <string>

#include "apps/bridge/messages/ros_messages.hpp"
#include "core/se3.hpp"
#include "motorcade/motorcade.hpp"

/// From results with `Axes::kRep103` to the messages of ROS 2.
namespace motorcade {

/// Names of the world, in which poses stand, and of what moves in it (REP 105): the vehicle, or the camera alone.
struct FrameIds {
  std::string world = "odom", child = "camera";
};

/// On the diagonal of what is not known [m^2, rad^2 and per s^2]: filters that invert the matrix then give the value no
/// weight, which a negative number would not do.
inline constexpr double kUnknownVariance = 1e6;

/// Rounded down to the second, so that `nanosec` counts forward. What 32 bits of seconds do not hold is their end.
ros::Time timeOf(std::int64_t stamp_ns);

ros::Header headerOf(const Result& result, const std::string& frame_id);

/// From the upper three rows of a matrix.
SE3 transformOf(const std::array<double, 12>& T_parent_child);
ros::Vector3 vectorOf(const Eigen::Vector3d& vector);
/// Its quaternion has w >= 0.
ros::Pose poseOf(const SE3& T_parent_child);

/// Of a perturbation on the right, T exp(rho, phi), to ROS' of the position and of a rotation about fixed axes, both in
/// the parent frame: t + R rho and exp(R phi) R, to first order, so J = diag(R, R).
ros::Covariance covarianceInParent(const Matrix6d& covariance, const Eigen::Matrix3d& R_parent_child);

ros::Covariance unknownCovariance();

ros::PoseStamped poseStampedOf(const Result& result, const FrameIds& ids);

/// The pose's covariance is wide where it is not known. The twist is the motion since the frame before, and its
/// covariance wide where nothing was measured.
ros::Odometry odometryOf(const Result& result, const FrameIds& ids);

ros::TransformStamped transformStampedOf(const Result& result, const FrameIds& ids);

}  // namespace motorcade
