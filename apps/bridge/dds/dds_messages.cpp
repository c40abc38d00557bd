#include "apps/bridge/dds/dds_messages.hpp"

#include <algorithm>
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

constexpr std::uint8_t kBoundingBox = 0;  // of autoware_perception_msgs/Shape; its footprint stays empty

autoware_perception_msgs_msg_dds__TrackedObjectKinematics_ ddsKinematics(const ros::TrackedObject& object) {
  return {.pose_with_covariance = ddsPose(object.pose, object.pose_covariance),
          .twist_with_covariance = ddsTwist(object.linear_mps, object.angular_radps, object.twist_covariance),
          .acceleration_with_covariance =
              ddsAcceleration(object.linear_mps2, object.angular_radps2, object.acceleration_covariance),
          .orientation_availability = static_cast<std::uint8_t>(object.orientation),
          .is_stationary = object.is_stationary};
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

DdsMarkers ddsView(const ros::MarkerArray& message) {
  DdsMarkers view(message.markers.size());
  for (std::size_t i = 0; i < message.markers.size(); ++i) {
    for (const ros::Vector3& point : message.markers[i].points)
      view.parts[i].push_back(ddsTriple<geometry_msgs_msg_dds__Point_>(point));
    view.items.push_back(ddsMarker(message.markers[i], view.parts[i]));
  }
  view.message.markers = ddsSequence<dds_sequence_visualization_msgs_msg_dds__Marker_>(view.items);
  return view;
}

DdsDiagnostics ddsView(const ros::DiagnosticArray& message) {
  DdsDiagnostics view(message.status.size());
  for (std::size_t i = 0; i < message.status.size(); ++i) {
    const ros::DiagnosticStatus& status = message.status[i];
    for (const auto& [key, value] : status.values)
      view.parts[i].push_back({.key = ddsText(key), .value = ddsText(value)});
    view.items.push_back({.level = static_cast<std::uint8_t>(status.level),
                          .name = ddsText(status.name),
                          .message = ddsText(status.message),
                          .hardware_id = ddsText(status.hardware_id),
                          .values = ddsSequence<dds_sequence_diagnostic_msgs_msg_dds__KeyValue_>(view.parts[i])});
  }
  view.message.header = ddsHeader(message.header);
  view.message.status = ddsSequence<dds_sequence_diagnostic_msgs_msg_dds__DiagnosticStatus_>(view.items);
  return view;
}

DdsTransform ddsView(const ros::TransformStamped& message) {
  DdsTransform view(1);
  view.items.push_back(ddsTransform(message));
  view.message.transforms = ddsSequence<dds_sequence_geometry_msgs_msg_dds__TransformStamped_>(view.items);
  return view;
}

DdsTrackedObjects ddsView(const ros::TrackedObjects& message) {
  DdsTrackedObjects view(message.objects.size());
  for (std::size_t i = 0; i < message.objects.size(); ++i) {
    const ros::TrackedObject& object = message.objects[i];
    for (const auto& [label, probability] : object.classification)
      view.parts[i].push_back({.label = static_cast<std::uint8_t>(label), .probability = probability});
    autoware_perception_msgs_msg_dds__TrackedObject_ item{};
    std::ranges::copy(object.object_id, item.object_id.uuid);
    item.existence_probability = object.existence_probability;
    item.classification =
        ddsSequence<dds_sequence_autoware_perception_msgs_msg_dds__ObjectClassification_>(view.parts[i]);
    item.kinematics = ddsKinematics(object);
    item.shape.type = kBoundingBox;
    item.shape.dimensions = ddsTriple(object.dimensions_m);
    view.items.push_back(item);
  }
  view.message.header = ddsHeader(message.header);
  view.message.objects = ddsSequence<dds_sequence_autoware_perception_msgs_msg_dds__TrackedObject_>(view.items);
  return view;
}

DdsDetections ddsView(const ros::Detection3DArray& message) {
  DdsDetections view(message.detections.size());
  for (std::size_t i = 0; i < message.detections.size(); ++i) {
    const ros::Detection3D& detection = message.detections[i];
    for (const ros::ObjectHypothesis& result : detection.results)
      view.parts[i].push_back({.hypothesis = {.class_id = ddsText(result.class_id), .score = result.score},
                               .pose = ddsPose(result.pose, result.covariance)});
    view.items.push_back(
        {.header = ddsHeader(message.header),
         .results = ddsSequence<dds_sequence_vision_msgs_msg_dds__ObjectHypothesisWithPose_>(view.parts[i]),
         .bbox = {.center = ddsPose(detection.box_center), .size = ddsTriple(detection.box_size_m)},
         .id = ddsText(detection.id)});
  }
  view.message.header = ddsHeader(message.header);
  view.message.detections = ddsSequence<dds_sequence_vision_msgs_msg_dds__Detection3D_>(view.items);
  return view;
}

}  // namespace motorcade
