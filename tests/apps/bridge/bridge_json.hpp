#pragma once

#include <cstdint>

#include <autoware_perception_msgs.h>
#include <diagnostic_msgs.h>
#include <geometry_msgs.h>
#include <nav_msgs.h>
#include <nlohmann/json.hpp>
#include <tf2_msgs.h>
#include <vision_msgs.h>
#include <visualization_msgs.h>

/// Messages of the bridge as JSON, for the process that subscribes in tests.
namespace motorcade::test {

using nlohmann::json;

/// The elements of a sequence of DDS.
template <class Sequence, class Convert>
json listOf(const Sequence& sequence, const Convert& convert) {
  json list = json::array();
  for (std::uint32_t i = 0; i < sequence._length; ++i) list.push_back(convert(sequence._buffer[i]));
  return list;
}

inline json jsonOf(const std_msgs_msg_dds__Header_& header) {
  return {{"sec", header.stamp.sec}, {"nanosec", header.stamp.nanosec}, {"frame_id", header.frame_id}};
}

inline json jsonOf(const geometry_msgs_msg_dds__Pose_& pose) {
  const auto& p = pose.position;
  const auto& q = pose.orientation;
  return {p.x, p.y, p.z, q.x, q.y, q.z, q.w};
}

template <class Vector>
json triple(const Vector& v) {
  return {v.x, v.y, v.z};
}

inline json jsonOf(const geometry_msgs_msg_dds__PoseStamped_& message) {
  return {{"header", jsonOf(message.header)}, {"pose", jsonOf(message.pose)}};
}

inline json jsonOf(const nav_msgs_msg_dds__Odometry_& message) {
  return {{"header", jsonOf(message.header)},
          {"child_frame_id", message.child_frame_id},
          {"pose", jsonOf(message.pose.pose)},
          {"pose_covariance", message.pose.covariance},
          {"linear", triple(message.twist.twist.linear)},
          {"angular", triple(message.twist.twist.angular)},
          {"twist_covariance", message.twist.covariance}};
}

inline json jsonOf(const visualization_msgs_msg_dds__Marker_& marker) {
  return {{"header", jsonOf(marker.header)},
          {"ns", marker.ns},
          {"id", marker.id},
          {"type", marker.type},
          {"action", marker.action},
          {"pose", jsonOf(marker.pose)},
          {"scale", triple(marker.scale)},
          {"points", marker.points._length},
          {"text", marker.text},
          {"lifetime_s", marker.lifetime.sec + 1e-9 * marker.lifetime.nanosec}};
}

inline json jsonOf(const visualization_msgs_msg_dds__MarkerArray_& message) {
  return {{"markers", listOf(message.markers, [](const auto& item) { return jsonOf(item); })}};
}

inline json jsonOf(const autoware_perception_msgs_msg_dds__ObjectClassification_& kind) {
  return {{"label", kind.label}, {"probability", kind.probability}};
}

inline json jsonOf(const autoware_perception_msgs_msg_dds__TrackedObject_& object) {
  const auto& kinematics = object.kinematics;
  const auto& twist = kinematics.twist_with_covariance;
  const auto& acceleration = kinematics.acceleration_with_covariance;
  return {{"id", object.object_id.uuid},
          {"existence_probability", object.existence_probability},
          {"classification", listOf(object.classification, [](const auto& item) { return jsonOf(item); })},
          {"pose", jsonOf(kinematics.pose_with_covariance.pose)},
          {"pose_covariance", kinematics.pose_with_covariance.covariance},
          {"linear", triple(twist.twist.linear)},
          {"angular", triple(twist.twist.angular)},
          {"twist_covariance", twist.covariance},
          {"linear_acceleration", triple(acceleration.accel.linear)},
          {"acceleration_covariance", acceleration.covariance},
          {"orientation_availability", kinematics.orientation_availability},
          {"is_stationary", kinematics.is_stationary},
          {"shape", object.shape.type},
          {"dimensions", triple(object.shape.dimensions)}};
}

inline json jsonOf(const autoware_perception_msgs_msg_dds__TrackedObjects_& message) {
  return {{"header", jsonOf(message.header)},
          {"objects", listOf(message.objects, [](const auto& item) { return jsonOf(item); })}};
}

inline json jsonOf(const vision_msgs_msg_dds__ObjectHypothesisWithPose_& result) {
  return {{"class_id", result.hypothesis.class_id},
          {"score", result.hypothesis.score},
          {"pose", jsonOf(result.pose.pose)},
          {"covariance", result.pose.covariance}};
}

inline json jsonOf(const vision_msgs_msg_dds__Detection3D_& detection) {
  return {{"header", jsonOf(detection.header)},
          {"results", listOf(detection.results, [](const auto& item) { return jsonOf(item); })},
          {"center", jsonOf(detection.bbox.center)},
          {"size", triple(detection.bbox.size)},
          {"id", detection.id}};
}

inline json jsonOf(const vision_msgs_msg_dds__Detection3DArray_& message) {
  return {{"header", jsonOf(message.header)},
          {"detections", listOf(message.detections, [](const auto& item) { return jsonOf(item); })}};
}

inline json jsonOf(const diagnostic_msgs_msg_dds__DiagnosticStatus_& status) {
  json values = json::object();
  for (std::uint32_t i = 0; i < status.values._length; ++i)
    values[status.values._buffer[i].key] = status.values._buffer[i].value;
  return {{"level", status.level},
          {"name", status.name},
          {"message", status.message},
          {"hardware_id", status.hardware_id},
          {"values", values}};
}

inline json jsonOf(const diagnostic_msgs_msg_dds__DiagnosticArray_& message) {
  return {{"header", jsonOf(message.header)},
          {"status", listOf(message.status, [](const auto& item) { return jsonOf(item); })}};
}

inline json jsonOf(const geometry_msgs_msg_dds__TransformStamped_& message) {
  const auto& t = message.transform.translation;
  const auto& q = message.transform.rotation;
  return {{"header", jsonOf(message.header)},
          {"child_frame_id", message.child_frame_id},
          {"pose", {t.x, t.y, t.z, q.x, q.y, q.z, q.w}}};
}

inline json jsonOf(const tf2_msgs_msg_dds__TFMessage_& message) {
  return {{"transforms", listOf(message.transforms, [](const auto& item) { return jsonOf(item); })}};
}

}  // namespace motorcade::test
