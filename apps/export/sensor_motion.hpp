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

/// An object as seen from a moving sensor. Derivatives are those of coordinates in the moving sensor's axes.
struct RelativeMotion {
  SE3 T_sensor_box;  // its origin is the middle of the cuboid, or of the body without one
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> acceleration_mps2{};    // empty where the object's own is not known
  Eigen::Vector3d turn_radps = Eigen::Vector3d::Zero();  // of the box against the sensor, in the box's axes
};

/// An object's motion as seen from a moving sensor. p is the center in the sensor's frame. v_o, a_o are its velocity
/// and acceleration in the world, on the sensor's axes. (v, w) is the sensor's twist and (v', w') its change:
///   dp/dt   = v_o - v - w x p
///   d2p/dt2 = a_o - w x v_o - v' - w' x p - w x dp/dt
/// The object's pose is in the world of the sensor's, `T_sensor_world` the sensor's in that frame.
RelativeMotion relativeMotion(const ObjectEstimate& object, const SE3& T_sensor_world, const SensorMotion& sensor);

/// The direction in which the object travels, in the world. For an object that stands it is the one that it faces.
Eigen::Vector3d directionOf(const ObjectEstimate& object);

}  // namespace motorcade
