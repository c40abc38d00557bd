#include "apps/bridge/messages/object_markers.hpp"

#include <cmath>
#include <cstdint>
#include <limits>

#include <fmt/format.h>

#include "apps/bridge/messages/matrix_rows.hpp"
#include "apps/bridge/messages/message_conversion.hpp"
#include "apps/bridge/messages/object_box.hpp"

namespace motorcade {
namespace {

constexpr double kTextHeight_m = 0.7, kTextAbove_m = 0.6;  // above the cuboid
constexpr double kShaft_m = 0.15, kHead_m = 0.35;          // diameters of an arrow
constexpr double kStanding_mps = 0.2;                      // slower, an arrow would be all head
constexpr float kOpaque = 1, kGlass = 0.6F, kFaint = 0.25F;

using Type = ros::Marker::Type;
using Action = ros::Marker::Action;

/// A marker's id of ROS, 32 bits. An id that is used again after 2^31 objects belonged to an object long gone.
std::int32_t markerId(std::int64_t object) {
  return static_cast<std::int32_t>(object & std::numeric_limits<std::int32_t>::max());
}

ros::Color colorOf(Result::State state) {
  switch (state) {
    case Result::State::kMoving:
      return {.r = 0.20F, .g = 0.75F, .b = 0.35F, .a = kGlass};
    case Result::State::kStopped:
      return {.r = 0.95F, .g = 0.65F, .b = 0.15F, .a = kGlass};
    case Result::State::kPredicted:
      return {.r = 0.60F, .g = 0.60F, .b = 0.65F, .a = kFaint};
  }
  return {};
}

ros::Color opaque(ros::Color color) {
  color.a = kOpaque;
  return color;
}

/// An object's cuboid in the world.
struct Placed {
  explicit Placed(const Result::Object& object)
      : T_world_box(transformOf(object.T_world_body) * boxInBody(object)),
        velocity_world_mps(vectorFrom(object.velocity_world_mps)) {}
  SE3 T_world_box;
  Eigen::Vector3d velocity_world_mps;
};

ros::Marker box(const Placed& placed, const Result::Object& object, ros::Marker marker) {
  const auto& [length_m, width_m, height_m] = object.box_size_m;
  marker.ns = "box";
  marker.type = Type::kCube;
  marker.pose = poseOf(placed.T_world_box);
  marker.scale = {length_m, width_m, height_m};
  marker.color = colorOf(object.state);
  return marker;
}

ros::Marker label(const Placed& placed, const Result::Object& object, ros::Marker marker) {
  const Eigen::Vector3d up(0, 0, object.box_size_m[2] / 2 + kTextAbove_m);
  marker.ns = "label";
  marker.type = Type::kText;
  marker.pose.position = vectorOf(placed.T_world_box * up);
  marker.scale.z = kTextHeight_m;
  marker.color = {.r = 1, .g = 1, .b = 1, .a = kOpaque};
  marker.text = fmt::format("{}: {:.1f} m/s", object.id, placed.velocity_world_mps.norm());
  return marker;
}

ros::Marker arrow(const Placed& placed, const Result::Object& object, ros::Marker marker) {
  const Eigen::Vector3d from = placed.T_world_box.translation();
  marker.ns = "velocity";
  marker.type = Type::kArrow;
  marker.scale = {kShaft_m, kHead_m, 0};
  marker.color = opaque(colorOf(object.state));
  marker.points = {vectorOf(from), vectorOf(Eigen::Vector3d(from + placed.velocity_world_mps))};
  return marker;
}

}  // namespace

void ObjectMarkers::add(const Result::Object& object, const ros::Marker& common, ros::MarkerArray& array) const {
  const Placed placed(object);
  ros::Marker marker = common;
  marker.id = markerId(object.id);
  if (object.box_size_m[0] > 0) array.markers.push_back(box(placed, object, marker));
  array.markers.push_back(label(placed, object, marker));
  if (placed.velocity_world_mps.norm() >= kStanding_mps) array.markers.push_back(arrow(placed, object, marker));
}

void ObjectMarkers::deleteWhatVanished(ros::Marker common, ros::MarkerArray& array) {
  std::set<Key> gone = std::move(shown_);
  shown_.clear();
  for (const ros::Marker& marker : array.markers) {
    if (marker.action != Action::kAdd) continue;
    shown_.emplace(marker.ns, marker.id);
    gone.erase({marker.ns, marker.id});
  }
  common.action = Action::kDelete;
  for (const auto& [ns, id] : gone) {
    common.ns = ns;
    common.id = id;
    array.markers.push_back(common);
  }
}

ros::MarkerArray ObjectMarkers::operator()(const Result& result) {
  ros::Marker common;
  common.header = {.stamp = timeOf(result.stamp_ns), .frame_id = params_.frame_id};
  ros::MarkerArray array;
  if (!begun_) array.markers.push_back(common);
  if (!begun_) array.markers.back().action = Action::kDeleteAll;
  begun_ = true;
  ros::Marker lasting = common;
  lasting.lifetime_ns = std::llround(1e9 * params_.lifetime_s);
  for (const Result::Object& object : result.objects) add(object, lasting, array);
  deleteWhatVanished(common, array);
  return array;
}

}  // namespace motorcade
