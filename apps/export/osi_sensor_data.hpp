#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "apps/export/sensor_motion.hpp"
#include "core/messages.hpp"
#include "core/se3.hpp"
#include "core/timestamp.hpp"

namespace osi3 {
class BaseMoving;
class DetectedMovingObject;
class Dimension3d;
class Orientation3d;
class SensorData;
class Timestamp;
class Vector3d;
}  // namespace osi3

/// Messages of ASAM OSI, and the fields that they share.
namespace motorcade {

/// The release of OSI whose messages are written.
struct OsiVersion {
  std::uint32_t major, minor, patch;
};
inline constexpr OsiVersion kOsiVersion{3, 7, 0};
/// The release whose rules the trace files follow: the first with rules for MCAP.
inline constexpr const char* kOsiTraceVersion = "3.8.0";

/// Roll, pitch and yaw [rad] of a rotation Rz(yaw) Ry(pitch) Rx(roll), the convention of ISO 8855. Roll is zero where
/// the pitch is a right angle, as only roll and yaw together are known there.
Eigen::Vector3d eulerAngles_rad(const Eigen::Matrix3d& rotation);

/// J in d(roll, pitch, yaw) = J dphi for a turn dphi about the rotated axes, R <- R exp(dphi). Empty within half a
/// degree of a vertical x axis, where the angles are not determined.
std::optional<Eigen::Matrix3d> eulerJacobian(const Eigen::Vector3d& angles_rad);

void set(osi3::Timestamp* message, Timestamp stamp);
void set(osi3::Vector3d* message, const Eigen::Vector3d& vector);
void set(osi3::Dimension3d* message, const Eigen::Vector3d& size_m);
/// Roll, pitch, yaw.
void set(osi3::Orientation3d* message, const Eigen::Vector3d& angles_rad);
/// Position and orientation.
void set(osi3::BaseMoving* message, const SE3& T_parent_box);

/// The standard deviations from a covariance's diagonal.
Eigen::Vector3d sigmasOf(const Eigen::Matrix3d& covariance);

/// Fills a detected object, in the sensor's frame (x ahead, y left, z up of the left camera). The object's pose is in
/// the world of `T_world_sensor`. Relative velocities need the sensor's motion and are left out without it.
void fill(osi3::DetectedMovingObject& message, const ObjectEstimate& object, const SE3& T_world_sensor,
          const std::optional<SensorMotion>& sensor);

/// A frame of a run, and the sensor's motion there.
struct SensedFrame {
  FrameEstimate estimate;
  std::optional<SensorMotion> motion{};
};

/// The sensor's pose: the left camera's with the axes that OSI gives to sensors, x ahead, y left, z up.
SE3 sensorPose(const SE3& T_world_cam);

/// Makes the message of a frame. With `T_vehicle_sensor` the host vehicle's pose is that of the vehicle's frame, in
/// that frame's first pose. Without it the sensor stands for the vehicle.
osi3::SensorData sensorData(const SensedFrame& frame, const std::optional<SE3>& T_vehicle_sensor);

}  // namespace motorcade
