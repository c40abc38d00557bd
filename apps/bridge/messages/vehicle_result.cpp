#include "apps/bridge/messages/vehicle_result.hpp"

#include "apps/bridge/messages/matrix_rows.hpp"
#include "apps/bridge/messages/message_conversion.hpp"

namespace motorcade {
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
