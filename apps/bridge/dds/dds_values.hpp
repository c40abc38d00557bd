#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <geometry_msgs.h>
#include <sensor_msgs.h>
#include <std_msgs.h>

#include "apps/bridge/messages/ros_messages.hpp"
#include "io/messages/camera_info_message.hpp"
#include "io/messages/image_message.hpp"
#include "motorcade/motorcade.hpp"

/// Values of messages to and from the types that idlc makes of apps/bridge/idl. Strings, sequences and pixels stay
/// those of the arguments.
namespace motorcade {

/// DDS has no constant types, but only reads a message that it writes.
inline char* ddsText(const std::string& text) { return const_cast<char*>(text.c_str()); }

template <class Sequence, class Item>
Sequence ddsSequence(std::vector<Item>& items) {
  const auto length = static_cast<std::uint32_t>(items.size());
  return {._maximum = length, ._length = length, ._buffer = items.data(), ._release = false};
}

template <class Triple = geometry_msgs_msg_dds__Vector3_>
Triple ddsTriple(const ros::Vector3& v) {
  return {.x = v.x, .y = v.y, .z = v.z};
}

std_msgs_msg_dds__Header_ ddsHeader(const ros::Header& header);
geometry_msgs_msg_dds__Pose_ ddsPose(const ros::Pose& pose);
geometry_msgs_msg_dds__TransformStamped_ ddsTransform(const ros::TransformStamped& message);
geometry_msgs_msg_dds__PoseWithCovariance_ ddsPose(const ros::Pose& pose, const ros::Covariance& covariance);
geometry_msgs_msg_dds__TwistWithCovariance_ ddsTwist(const ros::Vector3& linear, const ros::Vector3& angular,
                                                     const ros::Covariance& covariance);
geometry_msgs_msg_dds__AccelWithCovariance_ ddsAcceleration(const ros::Vector3& linear, const ros::Vector3& angular,
                                                            const ros::Covariance& covariance);

ImageMessage imageMessageOf(const sensor_msgs_msg_dds__Image_& sample);
CompressedImageMessage imageMessageOf(const sensor_msgs_msg_dds__CompressedImage_& sample);
/// Keeps one coefficient more than a model can have, so that readers refuse the message, and drops the others.
CameraInfoMessage cameraInfoMessageOf(const sensor_msgs_msg_dds__CameraInfo_& sample);
/// The speed along the vehicle's x axis and the turn rate about z, with their deviations where the covariance has them.
VehicleMotion vehicleMotionOf(const geometry_msgs_msg_dds__TwistWithCovarianceStamped_& sample);

}  // namespace motorcade
