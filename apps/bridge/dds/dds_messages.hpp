#pragma once

#include <vector>

#include <diagnostic_msgs.h>
#include <geometry_msgs.h>
#include <nav_msgs.h>
#include <tf2_msgs.h>
#include <visualization_msgs.h>

#include "apps/bridge/messages/ros_diagnostics.hpp"
#include "apps/bridge/messages/ros_messages.hpp"

/// Views of messages in the types that idlc makes of apps/bridge/idl: strings and sequences are those of the message,
/// which must outlive the view and is only read.
namespace motorcade {

geometry_msgs_msg_dds__PoseStamped_ ddsView(const ros::PoseStamped& message);
nav_msgs_msg_dds__Odometry_ ddsView(const ros::Odometry& message);

class MarkerArrayView {
 public:
  explicit MarkerArrayView(const ros::MarkerArray& message);
  MarkerArrayView(const MarkerArrayView&) = delete;
  MarkerArrayView& operator=(const MarkerArrayView&) = delete;
  const visualization_msgs_msg_dds__MarkerArray_& array() const { return array_; }

 private:
  std::vector<std::vector<geometry_msgs_msg_dds__Point_>> points_;  // of each marker
  std::vector<visualization_msgs_msg_dds__Marker_> markers_;
  visualization_msgs_msg_dds__MarkerArray_ array_{};
};

class DiagnosticArrayView {
 public:
  explicit DiagnosticArrayView(const ros::DiagnosticArray& message);
  DiagnosticArrayView(const DiagnosticArrayView&) = delete;
  DiagnosticArrayView& operator=(const DiagnosticArrayView&) = delete;
  const diagnostic_msgs_msg_dds__DiagnosticArray_& array() const { return array_; }

 private:
  std::vector<std::vector<diagnostic_msgs_msg_dds__KeyValue_>> values_;  // of each status
  std::vector<diagnostic_msgs_msg_dds__DiagnosticStatus_> status_;
  diagnostic_msgs_msg_dds__DiagnosticArray_ array_{};
};

/// A message of one transform.
class TfMessageView {
 public:
  explicit TfMessageView(const ros::TransformStamped& message);
  TfMessageView(const TfMessageView&) = delete;
  TfMessageView& operator=(const TfMessageView&) = delete;
  const tf2_msgs_msg_dds__TFMessage_& message() const { return message_; }

 private:
  std::vector<geometry_msgs_msg_dds__TransformStamped_> transforms_;
  tf2_msgs_msg_dds__TFMessage_ message_{};
};

}  // namespace motorcade
