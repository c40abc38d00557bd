#pragma once

#include <string>

#include "apps/bridge/messages/ros_messages.hpp"
#include "core/se3.hpp"
#include "motorcade/motorcade.hpp"

/// Converts results with `Axes::kRep103` to the messages of ROS 2.
namespace motorcade {

/// Names of the world, in which poses are given, and of the moving frame (REP 105): the vehicle, or the camera alone.
struct FrameIds {
  std::string world = "odom", child = "camera";
};

/// Variance of unknown quantities [m^2, rad^2 and per s^2]. Filters that invert the matrix give the value no weight,
/// which a negative number would not achieve.
inline constexpr double kUnknownVariance = 1e6;

/// Rounded down to the second, so that `nanosec` counts forward. Times beyond 32 bits of seconds are clamped.
ros::Time timeOf(std::int64_t stamp_ns);

ros::Header headerOf(const Result& result, const std::string& frame_id);

/// Transform from the upper three rows of its matrix, row by row.
SE3 transformOf(const std::array<double, 12>& T_parent_child);
ros::Vector3 vectorOf(const Eigen::Vector3d& vector);
/// Its quaternion has w >= 0.
ros::Pose poseOf(const SE3& T_parent_child);

/// Converts the covariance of a right perturbation, T exp(rho, phi), to ROS' axes. ROS perturbs the position and
/// rotates about fixed axes, both in the parent frame: t + R rho and exp(R phi) R. To first order J = diag(R, R).
ros::Covariance covarianceInParent(const Matrix6d& covariance, const Eigen::Matrix3d& R_parent_child);

ros::Covariance unknownCovariance();

ros::PoseStamped poseStampedOf(const Result& result, const FrameIds& ids);

/// The camera's pose and twist. The pose's covariance is wide where it is not known. The twist is the motion since the
/// previous frame; its covariance is wide where nothing was measured.
ros::Odometry odometryOf(const Result& result, const FrameIds& ids);

ros::TransformStamped transformStampedOf(const Result& result, const FrameIds& ids);

/// Converts a result of the camera to one of the vehicle that carries it. Its "cam" is the vehicle's frame, its "world"
/// that frame in the first pair. With M = T_vehicle_cam,
///   T_world_vehicle = M T_world_cam M^-1,   T exp(xi) becomes M T exp(xi) M^-1 = T_world_vehicle exp(Ad(M) xi),
/// so Ad(M) carries motions and twists, and Ad(M) C Ad(M)' their covariances. An object's covariance stays, as it is of
/// a perturbation in the body's own axes.
Result seenFromVehicle(Result result, const SE3& T_vehicle_cam);

}  // namespace motorcade
