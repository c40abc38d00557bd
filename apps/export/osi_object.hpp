#pragma once

#include <optional>

#include "apps/export/sensor_motion.hpp"
#include "core/messages.hpp"

namespace osi3 {
class DetectedMovingObject;
}  // namespace osi3

namespace motorcade {

/// Fills a detected object, in the sensor's frame (x ahead, y left, z up of the left camera). The object's pose is in
/// the world of `T_world_sensor`. Relative velocities need the sensor's motion and are left out without it.
void fill(osi3::DetectedMovingObject& message, const ObjectEstimate& object, const SE3& T_world_sensor,
          const std::optional<SensorMotion>& sensor);

}  // namespace motorcade
