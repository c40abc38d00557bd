#include "apps/export/osi_fields.hpp"

#include <osi3/osi_common.pb.h>

#include "apps/export/euler_angles.hpp"

namespace motorcade {

void set(osi3::Timestamp* message, Timestamp stamp) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t rest_ns = (stamp.ns % kSecond_ns + kSecond_ns) % kSecond_ns;  // never negative
  message->set_seconds((stamp.ns - rest_ns) / kSecond_ns);
  message->set_nanos(static_cast<std::uint32_t>(rest_ns));
}

void set(osi3::Vector3d* message, const Eigen::Vector3d& vector) {
  message->set_x(vector.x());
  message->set_y(vector.y());
  message->set_z(vector.z());
}

void set(osi3::Dimension3d* message, const Eigen::Vector3d& size_m) {
  message->set_length(size_m.x());
  message->set_width(size_m.y());
  message->set_height(size_m.z());
}

void set(osi3::Orientation3d* message, const Eigen::Vector3d& angles_rad) {
  message->set_roll(angles_rad[0]);
  message->set_pitch(angles_rad[1]);
  message->set_yaw(angles_rad[2]);
}

void set(osi3::BaseMoving* message, const SE3& T_parent_box) {
  set(message->mutable_position(), T_parent_box.translation());
  set(message->mutable_orientation(), eulerAngles_rad(T_parent_box.rotation()));
}

Eigen::Vector3d sigmasOf(const Eigen::Matrix3d& covariance) { return covariance.diagonal().cwiseMax(0).cwiseSqrt(); }

void setAngleErrors(osi3::BaseMoving* message, const Eigen::Matrix3d& rotation,
                    const Eigen::Matrix3d& turn_covariance) {
  if (const auto J = eulerJacobian(eulerAngles_rad(rotation)))
    set(message->mutable_orientation(), sigmasOf(*J * turn_covariance * J->transpose()));
}

void setAngleRates(osi3::BaseMoving* message, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& turn_radps) {
  if (const auto J = eulerJacobian(eulerAngles_rad(rotation)))
    set(message->mutable_orientation_rate(), *J * turn_radps);
}

}  // namespace motorcade
