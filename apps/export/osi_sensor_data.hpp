#pragma once

#include <optional>

#include "apps/export/sensor_motion.hpp"
#include "core/messages.hpp"

namespace osi3 {
class SensorData;
}  // namespace osi3

namespace motorcade {

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
