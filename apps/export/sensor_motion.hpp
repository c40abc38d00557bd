#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/messages.hpp"

namespace motorcade {

struct TimedPose {
  FrameHead head;
  SE3 T_world_sensor;
};

/// The velocity (m/s, then rad/s) of a sensor in its own axes, and its change per second.
struct SensorMotion {
  Vector6d twist = Vector6d::Zero(), change = Vector6d::Zero();
};

/// The motion in one frame, by a quadratic least-squares fit to the poses around it: those within 0.35 s, at least
/// those of the adjacent frames. With xi_j = log(T_i^-1 T_j) at time t_j since frame i,
///   xi_j = c + twist t_j + change t_j^2 / 2.
/// Empty where fewer than three frames of the same segment are near. Rejected frames, whose times may be wrong, do not
/// count.
std::optional<SensorMotion> sensorMotionAt(const std::vector<TimedPose>& way, std::size_t index);

}  // namespace motorcade
