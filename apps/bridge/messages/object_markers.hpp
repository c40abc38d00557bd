#pragma once

#include <set>
#include <string>
#include <utility>

#include "apps/bridge/messages/ros_messages.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

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
