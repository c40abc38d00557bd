#pragma once

#include <cstdint>
#include <string>

#include "apps/bridge/messages/ros_objects.hpp"
#include "core/se3.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// Velocity (m/s) and turn rate (rad/s) of an object over ground, along its own axes, at its cuboid's middle c. R is
/// the rotation of the body in the world, v the velocity of its origin and w its yaw rate:
///   v_c = R' v + w (e_z x c),   J = [R', e_z x c; 0, 0; 0, 1] over (v, w)
/// The errors of v and w are taken as independent. Roll and pitch rates are not known.
struct ObjectTwist {
  Vector6d value;
  Matrix6d covariance;
};
ObjectTwist twistOf(const Result::Object& object);

/// All objects of a result, predicted ones too, in the world, as an observer at rest sees them move. Covariances are as
/// seen from the camera of the same frame. They leave out the uncertainty of the camera's own path, which moves all
/// objects alike. `first_stamp_ns` is that of the tracker's first result.
ros::TrackedObjects trackedObjectsOf(const Result& result, const std::string& world, std::int64_t first_stamp_ns);

}  // namespace motorcade
