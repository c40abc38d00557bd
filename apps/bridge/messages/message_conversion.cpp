#include "apps/bridge/messages/message_conversion.hpp"

#include <limits>

#include <Eigen/Geometry>

#include "apps/bridge/messages/object_fields.hpp"

namespace motorcade {

ros::Time timeOf(std::int64_t stamp_ns) {
  constexpr std::int64_t kNanoseconds = 1'000'000'000;
  using Seconds = std::numeric_limits<std::int32_t>;
  const std::int64_t floor_s = stamp_ns / kNanoseconds - (stamp_ns % kNanoseconds < 0 ? 1 : 0);
  if (floor_s > Seconds::max()) return {Seconds::max(), kNanoseconds - 1};
  if (floor_s < Seconds::min()) return {Seconds::min(), 0};
  return {static_cast<std::int32_t>(floor_s), static_cast<std::uint32_t>(stamp_ns - floor_s * kNanoseconds)};
}

ros::Header headerOf(const Result& result, const std::string& frame_id) {
  return {.stamp = timeOf(result.stamp_ns), .frame_id = frame_id};
}

SE3 transformOf(const std::array<double, 12>& T_parent_child) {
  const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> rows(T_parent_child.data());
  return {rows.leftCols<3>(), rows.col(3)};
}

ros::Vector3 vectorOf(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

ros::Pose poseOf(const SE3& T_parent_child) {
  Eigen::Quaterniond q(T_parent_child.rotation());
  q.normalize();
  if (q.w() < 0) q.coeffs() *= -1;
  return {.position = vectorOf(T_parent_child.translation()), .orientation = {q.x(), q.y(), q.z(), q.w()}};
}

ros::Covariance covarianceInParent(const Matrix6d& covariance, const Eigen::Matrix3d& R_parent_child) {
  Matrix6d J = Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = J.bottomRightCorner<3, 3>() = R_parent_child;
  return rowsOf<6>(J * covariance * J.transpose());
}

ros::Covariance unknownCovariance() { return rowsOf<6>(kUnknownVariance * Matrix6d::Identity()); }

ros::PoseStamped poseStampedOf(const Result& result, const FrameIds& ids) {
  return {.header = headerOf(result, ids.world), .pose = poseOf(transformOf(result.T_world_cam))};
}

ros::Odometry odometryOf(const Result& result, const FrameIds& ids) {
  const SE3 T_world_cam = transformOf(result.T_world_cam);
  const auto& v = result.velocity;
  const ros::Covariance pose_covariance =
      result.pose_covariance ? covarianceInParent(matrixOf<6>(*result.pose_covariance), T_world_cam.rotation())
                             : unknownCovariance();
  return {.header = headerOf(result, ids.world),
          .child_frame_id = ids.child,
          .pose = poseOf(T_world_cam),
          .pose_covariance = pose_covariance,
          .linear_mps = {v[0], v[1], v[2]},
          .angular_radps = {v[3], v[4], v[5]},
          .twist_covariance = result.velocity_covariance};
}

ros::TransformStamped transformStampedOf(const Result& result, const FrameIds& ids) {
  return {.header = headerOf(result, ids.world),
          .child_frame_id = ids.child,
          .transform = poseOf(transformOf(result.T_world_cam))};
}

namespace {

void carry(const SE3& T_vehicle_cam, Result::Object& object) {
  const Eigen::Matrix3d& R = T_vehicle_cam.rotation();
  object.T_world_body = rowsOf(T_vehicle_cam * transformOf(object.T_world_body));
  object.T_cam_body = rowsOf(T_vehicle_cam * transformOf(object.T_cam_body));
  Eigen::Map<Eigen::Vector3d>(object.velocity_world_mps.data()) = R * vectorFrom(object.velocity_world_mps);
  object.velocity_covariance = rowsOf<3>(R * matrixOf<3>(object.velocity_covariance) * R.transpose());
}

}  // namespace

Result seenFromVehicle(Result result, const SE3& T_vehicle_cam) {
  const Matrix6d adjoint = T_vehicle_cam.adjoint();
  const auto carried = [&](const std::array<double, 36>& covariance) {
    return rowsOf<6>(adjoint * matrixOf<6>(covariance) * adjoint.transpose());
  };
  result.T_world_cam = rowsOf(T_vehicle_cam * transformOf(result.T_world_cam) * T_vehicle_cam.inverse());
  if (result.pose_covariance) result.pose_covariance = carried(*result.pose_covariance);
  if (result.motion_covariance) result.motion_covariance = carried(*result.motion_covariance);
  const Vector6d velocity = adjoint * Eigen::Map<const Vector6d>(result.velocity.data());
  Eigen::Map<Vector6d>(result.velocity.data()) = velocity;
  result.velocity_covariance = carried(result.velocity_covariance);
  for (Result::Object& object : result.objects) carry(T_vehicle_cam, object);
  return result;
}

}  // namespace motorcade
