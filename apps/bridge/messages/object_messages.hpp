#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <utility>

#include "apps/bridge/messages/ros_messages.hpp"
#include "apps/bridge/messages/ros_objects.hpp"
#include "core/se3.hpp"
#include "motorcade/motorcade.hpp"

/// A frame's objects as messages: tracked objects, detections and markers.
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

/// The objects that were seen in a frame, in the frame `child`, the camera or the vehicle. Predicted ones are left out.
/// The scores of an object's hypotheses sum to the probability that it exists. `first_stamp_ns` is that of the
/// tracker's first result.
ros::Detection3DArray detectionsOf(const Result& result, const std::string& child, std::int64_t first_stamp_ns);

/// Shows the objects of each result as markers in the world. In the namespace `box` it is a cube, where its size is
/// known, in `label` its id and speed, in `velocity` an arrow of one second's motion. The marker's id is the object's.
/// Markers of objects that are gone are deleted. The first array deletes all markers of an earlier publisher. Call it
/// in frame order.
class ObjectMarkers {
 public:
  struct Params {
    std::string frame_id{};
    double lifetime_s = 1;  // after which a marker vanishes that is not renewed
  };
  explicit ObjectMarkers(Params params) : params_(std::move(params)) {}
  ros::MarkerArray operator()(const Result& result);

 private:
  using Key = std::pair<std::string, std::int32_t>;  // namespace, id
  void add(const Result::Object& object, const ros::Marker& common, ros::MarkerArray& array) const;
  void deleteWhatVanished(ros::Marker common, ros::MarkerArray& array);

  Params params_;
  bool begun_ = false;
  std::set<Key> shown_;
};

}  // namespace motorcade
