#pragma once

#include <vector>

#include <autoware_perception_msgs.h>
#include <diagnostic_msgs.h>
#include <geometry_msgs.h>
#include <nav_msgs.h>
#include <tf2_msgs.h>
#include <vision_msgs.h>
#include <visualization_msgs.h>

#include "apps/bridge/messages/diagnostics.hpp"
#include "apps/bridge/messages/ros_messages.hpp"
#include "apps/bridge/messages/ros_objects.hpp"

/// Views of messages in the types that idlc makes of apps/bridge/idl: strings and sequences are those of the message,
/// which must outlive the view and is only read.
namespace motorcade {

geometry_msgs_msg_dds__PoseStamped_ ddsView(const ros::PoseStamped& message);
nav_msgs_msg_dds__Odometry_ ddsView(const ros::Odometry& message);

/// A message of items that have lists of parts, and what its sequences point to.
template <class Message, class Item, class Part>
struct DdsListView {
  explicit DdsListView(std::size_t count) : parts(count) { items.reserve(count); }
  DdsListView(DdsListView&&) noexcept = default;  // lists stay where they are

  std::vector<std::vector<Part>> parts;  // of each item
  std::vector<Item> items{};
  Message message{};
};

using DdsMarkers = DdsListView<visualization_msgs_msg_dds__MarkerArray_, visualization_msgs_msg_dds__Marker_,
                               geometry_msgs_msg_dds__Point_>;
DdsMarkers ddsView(const ros::MarkerArray& message);
using DdsDiagnostics = DdsListView<diagnostic_msgs_msg_dds__DiagnosticArray_,
                                   diagnostic_msgs_msg_dds__DiagnosticStatus_, diagnostic_msgs_msg_dds__KeyValue_>;
DdsDiagnostics ddsView(const ros::DiagnosticArray& message);
using DdsTrackedObjects =
    DdsListView<autoware_perception_msgs_msg_dds__TrackedObjects_, autoware_perception_msgs_msg_dds__TrackedObject_,
                autoware_perception_msgs_msg_dds__ObjectClassification_>;
DdsTrackedObjects ddsView(const ros::TrackedObjects& message);
using DdsDetections = DdsListView<vision_msgs_msg_dds__Detection3DArray_, vision_msgs_msg_dds__Detection3D_,
                                  vision_msgs_msg_dds__ObjectHypothesisWithPose_>;
DdsDetections ddsView(const ros::Detection3DArray& message);
/// A message of one transform, which has no parts.
using DdsTransform = DdsListView<tf2_msgs_msg_dds__TFMessage_, geometry_msgs_msg_dds__TransformStamped_, char>;
DdsTransform ddsView(const ros::TransformStamped& message);

}  // namespace motorcade
