#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <geometry_msgs.h>
#include <std_msgs.h>

#include "apps/bridge/messages/ros_messages.hpp"

/// Parts of messages in the types that idlc makes of apps/bridge/idl. Strings and sequences are those of the arguments.
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

}  // namespace motorcade
