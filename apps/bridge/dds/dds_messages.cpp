#include "apps/bridge/dds/dds_messages.hpp"

#include <string>

#include "apps/bridge/dds/dds_values.hpp"
#include "apps/bridge/messages/message_conversion.hpp"

namespace motorcade {
namespace {

const std::string kNoText;

visualization_msgs_msg_dds__Marker_ ddsMarker(const ros::Marker& marker,
                                              std::vector<geometry_msgs_msg_dds__Point_>& points) {
  const ros::Time lifetime = timeOf(marker.lifetime_ns);
  const ros::Color& color = marker.color;
  visualization_msgs_msg_dds__Marker_ view{};
  view.header = ddsHeader(marker.header);
  view.ns = ddsText(marker.ns);
  view.id = marker.id;
  view.type = static_cast<std::int32_t>(marker.type);
  view.action = static_cast<std::int32_t>(marker.action);
  view.pose = ddsPose(marker.pose);
  view.scale = ddsTriple(marker.scale);
  view.color = {.r = color.r, .g = color.g, .b = color.b, .a = color.a};
  view.lifetime = {.sec = lifetime.sec, .nanosec = lifetime.nanosec};
  view.points = ddsSequence<dds_sequence_geometry_msgs_msg_dds__Point_>(points);
  view.text = ddsText(marker.text);
  for (char** const unused : {&view.texture_resource, &view.texture.header.frame_id, &view.texture.format,
                              &view.mesh_resource, &view.mesh_file.filename})
    *unused = ddsText(kNoText);
  return view;
}

}  // namespace

geometry_msgs_msg_dds__PoseStamped_ ddsView(const ros::PoseStamped& message) {
  return {.header = ddsHeader(message.header), .pose = ddsPose(message.pose)};
}

nav_msgs_msg_dds__Odometry_ ddsView(const ros::Odometry& message) {
  return {.header = ddsHeader(message.header),
          .child_frame_id = ddsText(message.child_frame_id),
          .pose = ddsPose(message.pose, message.pose_covariance),
          .twist = ddsTwist(message.linear_mps, message.angular_radps, message.twist_covariance)};
}

MarkerArrayView::MarkerArrayView(const ros::MarkerArray& message) : points_(message.markers.size()) {
  markers_.reserve(message.markers.size());
  for (std::size_t i = 0; i < message.markers.size(); ++i) {
    for (const ros::Vector3& point : message.markers[i].points)
      points_[i].push_back(ddsTriple<geometry_msgs_msg_dds__Point_>(point));
    markers_.push_back(ddsMarker(message.markers[i], points_[i]));
  }
  array_.markers = ddsSequence<dds_sequence_visualization_msgs_msg_dds__Marker_>(markers_);
}

DiagnosticArrayView::DiagnosticArrayView(const ros::DiagnosticArray& message) : values_(message.status.size()) {
  for (std::size_t i = 0; i < message.status.size(); ++i) {
    const ros::DiagnosticStatus& status = message.status[i];
    for (const auto& [key, value] : status.values) values_[i].push_back({.key = ddsText(key), .value = ddsText(value)});
    status_.push_back({.level = static_cast<std::uint8_t>(status.level),
                       .name = ddsText(status.name),
                       .message = ddsText(status.message),
                       .hardware_id = ddsText(status.hardware_id),
                       .values = ddsSequence<dds_sequence_diagnostic_msgs_msg_dds__KeyValue_>(values_[i])});
  }
  array_.header = ddsHeader(message.header);
  array_.status = ddsSequence<dds_sequence_diagnostic_msgs_msg_dds__DiagnosticStatus_>(status_);
}

TfMessageView::TfMessageView(const ros::TransformStamped& message) : transforms_{ddsTransform(message)} {
  message_.transforms = ddsSequence<dds_sequence_geometry_msgs_msg_dds__TransformStamped_>(transforms_);
}

}  // namespace motorcade
