#pragma once

#include <vector>

#include <autoware_perception_msgs.h>
#include <vision_msgs.h>

#include "apps/bridge/messages/ros_objects.hpp"

/// Views of messages about objects, as those of dds_messages.hpp.
namespace motorcade {

class TrackedObjectsView {
 public:
  explicit TrackedObjectsView(const ros::TrackedObjects& message);
  TrackedObjectsView(const TrackedObjectsView&) = delete;
  TrackedObjectsView& operator=(const TrackedObjectsView&) = delete;
  const autoware_perception_msgs_msg_dds__TrackedObjects_& message() const { return message_; }

 private:
  std::vector<std::vector<autoware_perception_msgs_msg_dds__ObjectClassification_>> classifications_;  // of each object
  std::vector<autoware_perception_msgs_msg_dds__TrackedObject_> objects_;
  autoware_perception_msgs_msg_dds__TrackedObjects_ message_{};
};

class Detection3DArrayView {
 public:
  explicit Detection3DArrayView(const ros::Detection3DArray& message);
  Detection3DArrayView(const Detection3DArrayView&) = delete;
  Detection3DArrayView& operator=(const Detection3DArrayView&) = delete;
  const vision_msgs_msg_dds__Detection3DArray_& array() const { return array_; }

 private:
  std::vector<std::vector<vision_msgs_msg_dds__ObjectHypothesisWithPose_>> results_;  // of each detection
  std::vector<vision_msgs_msg_dds__Detection3D_> detections_;
  vision_msgs_msg_dds__Detection3DArray_ array_{};
};

}  // namespace motorcade
