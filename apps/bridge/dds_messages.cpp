#include "apps/bridge/dds_messages.hpp"

#include <algorithm>
#include <string>

#include "apps/bridge/message_conversion.hpp"

namespace motorcade {
namespace {

/// DDS has no constant types; what writes a message only reads it.
char* dds(const std::string& text) { return const_cast<char*>(text.c_str()); }

const std::string kNoText;

builtin_interfaces_msg_dds__Time_ dds(const ros::Time& time) { return {.sec = time.sec, .nanosec = time.nanosec}; }

std_msgs_msg_dds__Header_ dds(const ros::Header& header) {
  return {.stamp = dds(header.stamp), .frame_id = dds(header.frame_id)};
}

template <class Triple>
Triple triple(const ros::Vector3& v) {
  return {.x = v.x, .y = v.y, .z = v.z};
}

geometry_msgs_msg_dds__Pose_ dds(const ros::Pose& pose) {
  const ros::Quaternion& q = pose.orientation;
  return {.position = triple<geometry_msgs_msg_dds__Point_>(pose.position),
          .orientation = {.x = q.x, .y = q.y, .z = q.z, .w = q.w}};
}

template <class Sequence, class Item>
Sequence sequenceOf(std::vector<Item>& items) {
  const auto length = static_cast<std::uint32_t>(items.size());
  return {._maximum = length, ._length = length, ._buffer = items.data(), ._release = false};
}

visualization_msgs_msg_dds__Marker_ dds(const ros::Marker& marker, std::vector<geometry_msgs_msg_dds__Point_>& points) {
  const ros::Time lifetime = timeOf(marker.lifetime_ns);
  const ros::Color& color = marker.color;
  visualization_msgs_msg_dds__Marker_ view{};
  view.header = dds(marker.header);
  view.ns = dds(marker.ns);
  view.id = marker.id;
  view.type = static_cast<std::int32_t>(marker.type);
  view.action = static_cast<std::int32_t>(marker.action);
  view.pose = dds(marker.pose);
  view.scale = triple<geometry_msgs_msg_dds__Vector3_>(marker.scale);
  view.color = {.r = color.r, .g = color.g, .b = color.b, .a = color.a};
  view.lifetime = {.sec = lifetime.sec, .nanosec = lifetime.nanosec};
  view.points = sequenceOf<dds_sequence_geometry_msgs_msg_dds__Point_>(points);
  view.text = dds(marker.text);
  for (char** const unused : {&view.texture_resource, &view.texture.header.frame_id, &view.texture.format,
                              &view.mesh_resource, &view.mesh_file.filename})
    *unused = dds(kNoText);
  return view;
}

}  // namespace

geometry_msgs_msg_dds__PoseStamped_ ddsView(const ros::PoseStamped& message) {
  return {.header = dds(message.header), .pose = dds(message.pose)};
}

nav_msgs_msg_dds__Odometry_ ddsView(const ros::Odometry& message) {
  nav_msgs_msg_dds__Odometry_ view{};
  view.header = dds(message.header);
  view.child_frame_id = dds(message.child_frame_id);
  view.pose.pose = dds(message.pose);
  view.twist.twist.linear = triple<geometry_msgs_msg_dds__Vector3_>(message.linear_mps);
  view.twist.twist.angular = triple<geometry_msgs_msg_dds__Vector3_>(message.angular_radps);
  std::ranges::copy(message.pose_covariance, view.pose.covariance);
  std::ranges::copy(message.twist_covariance, view.twist.covariance);
  return view;
}

MarkerArrayView::MarkerArrayView(const ros::MarkerArray& message) : points_(message.markers.size()) {
  markers_.reserve(message.markers.size());
  for (std::size_t i = 0; i < message.markers.size(); ++i) {
    for (const ros::Vector3& point : message.markers[i].points)
      points_[i].push_back(triple<geometry_msgs_msg_dds__Point_>(point));
    markers_.push_back(dds(message.markers[i], points_[i]));
  }
  array_.markers = sequenceOf<dds_sequence_visualization_msgs_msg_dds__Marker_>(markers_);
}

}  // namespace motorcade
