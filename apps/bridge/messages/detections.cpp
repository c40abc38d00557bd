#include "apps/bridge/messages/detections.hpp"

#include "apps/bridge/messages/message_conversion.hpp"
#include "apps/bridge/messages/object_box.hpp"
#include "apps/bridge/messages/object_kinds.hpp"
#include "apps/bridge/messages/object_uuid.hpp"

namespace motorcade {
namespace {

/// The kind's name in the column `kind` of a run's files.
const char* classIdOf(Result::Kind kind) {
  switch (kind) {
    case Result::Kind::kUnknown:
      return "unknown";
    case Result::Kind::kCar:
      return "car";
    case Result::Kind::kLargeVehicle:
      return "large_vehicle";
    case Result::Kind::kTwoWheeler:
      return "two_wheeler";
    case Result::Kind::kPedestrian:
      return "pedestrian";
  }
  return "unknown";
}

ros::Detection3D detectionOf(const Result::Object& object, std::int64_t first_stamp_ns) {
  const auto& [length_m, width_m, height_m] = object.box_size_m;
  const SE3 T_child_box = transformOf(object.T_cam_body) * boxInBody(object);
  const auto covariance = boxCovariance(object);
  ros::Detection3D detection;
  detection.box_center = poseOf(T_child_box);
  detection.box_size_m = {length_m, width_m, height_m};
  detection.id = textOf(uuidOf(object.id, first_stamp_ns));
  for (const KindShare& share : kindShares(object))
    detection.results.push_back(
        {.class_id = classIdOf(share.kind),
         .score = object.existence_probability * share.probability,
         .pose = detection.box_center,
         .covariance = covariance ? covarianceInParent(*covariance, T_child_box.rotation()) : unknownCovariance()});
  return detection;
}

}  // namespace

ros::Detection3DArray detectionsOf(const Result& result, const std::string& child, std::int64_t first_stamp_ns) {
  ros::Detection3DArray message{.header = headerOf(result, child), .detections = {}};
  for (const Result::Object& object : result.objects)
    if (object.state != Result::State::kPredicted) message.detections.push_back(detectionOf(object, first_stamp_ns));
  return message;
}

}  // namespace motorcade
