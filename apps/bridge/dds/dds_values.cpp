#include "apps/bridge/dds/dds_values.hpp"

#include <algorithm>

namespace motorcade {
namespace {

geometry_msgs_msg_dds__Quaternion_ ddsQuaternion(const ros::Quaternion& q) {
  return {.x = q.x, .y = q.y, .z = q.z, .w = q.w};
}

}  // namespace

std_msgs_msg_dds__Header_ ddsHeader(const ros::Header& header) {
  return {.stamp = {.sec = header.stamp.sec, .nanosec = header.stamp.nanosec}, .frame_id = ddsText(header.frame_id)};
}

geometry_msgs_msg_dds__Pose_ ddsPose(const ros::Pose& pose) {
  return {.position = ddsTriple<geometry_msgs_msg_dds__Point_>(pose.position),
          .orientation = ddsQuaternion(pose.orientation)};
}

geometry_msgs_msg_dds__PoseWithCovariance_ ddsPose(const ros::Pose& pose, const ros::Covariance& covariance) {
  geometry_msgs_msg_dds__PoseWithCovariance_ view{};
  view.pose = ddsPose(pose);
  std::ranges::copy(covariance, view.covariance);
  return view;
}

geometry_msgs_msg_dds__TwistWithCovariance_ ddsTwist(const ros::Vector3& linear, const ros::Vector3& angular,
                                                     const ros::Covariance& covariance) {
  geometry_msgs_msg_dds__TwistWithCovariance_ view{};
  view.twist = {.linear = ddsTriple(linear), .angular = ddsTriple(angular)};
  std::ranges::copy(covariance, view.covariance);
  return view;
}

geometry_msgs_msg_dds__AccelWithCovariance_ ddsAcceleration(const ros::Vector3& linear, const ros::Vector3& angular,
                                                            const ros::Covariance& covariance) {
  geometry_msgs_msg_dds__AccelWithCovariance_ view{};
  view.accel = {.linear = ddsTriple(linear), .angular = ddsTriple(angular)};
  std::ranges::copy(covariance, view.covariance);
  return view;
}

geometry_msgs_msg_dds__TransformStamped_ ddsTransform(const ros::TransformStamped& message) {
  return {.header = ddsHeader(message.header),
          .child_frame_id = ddsText(message.child_frame_id),
          .transform = {.translation = ddsTriple(message.transform.position),
                        .rotation = ddsQuaternion(message.transform.orientation)}};
}

}  // namespace motorcade
