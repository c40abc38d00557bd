#include "apps/bridge/dds/dds_objects.hpp"

#include <algorithm>

#include "apps/bridge/dds/dds_values.hpp"

namespace motorcade {
namespace {

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

TrackedObjectsView::TrackedObjectsView(const ros::TrackedObjects& message) : classifications_(message.objects.size()) {
  objects_.reserve(message.objects.size());
  for (std::size_t i = 0; i < message.objects.size(); ++i) {
    const ros::TrackedObject& object = message.objects[i];
    for (const auto& [label, probability] : object.classification)
      classifications_[i].push_back({.label = static_cast<std::uint8_t>(label), .probability = probability});
    autoware_perception_msgs_msg_dds__TrackedObject_ view{};
    std::ranges::copy(object.object_id, view.object_id.uuid);
    view.existence_probability = object.existence_probability;
    view.classification =
        ddsSequence<dds_sequence_autoware_perception_msgs_msg_dds__ObjectClassification_>(classifications_[i]);
    view.kinematics = ddsKinematics(object);
    view.shape.type = kBoundingBox;
    view.shape.dimensions = ddsTriple(object.dimensions_m);
    objects_.push_back(view);
  }
  message_.header = ddsHeader(message.header);
  message_.objects = ddsSequence<dds_sequence_autoware_perception_msgs_msg_dds__TrackedObject_>(objects_);
}

Detection3DArrayView::Detection3DArrayView(const ros::Detection3DArray& message) : results_(message.detections.size()) {
  detections_.reserve(message.detections.size());
  for (std::size_t i = 0; i < message.detections.size(); ++i) {
    const ros::Detection3D& detection = message.detections[i];
    for (const ros::ObjectHypothesis& result : detection.results)
      results_[i].push_back({.hypothesis = {.class_id = ddsText(result.class_id), .score = result.score},
                             .pose = ddsPose(result.pose, result.covariance)});
    detections_.push_back(
        {.header = ddsHeader(message.header),
         .results = ddsSequence<dds_sequence_vision_msgs_msg_dds__ObjectHypothesisWithPose_>(results_[i]),
         .bbox = {.center = ddsPose(detection.box_center), .size = ddsTriple(detection.box_size_m)},
         .id = ddsText(detection.id)});
  }
  array_.header = ddsHeader(message.header);
  array_.detections = ddsSequence<dds_sequence_vision_msgs_msg_dds__Detection3D_>(detections_);
}

}  // namespace motorcade
