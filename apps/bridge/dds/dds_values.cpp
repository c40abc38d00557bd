#include "apps/bridge/dds/dds_values.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace motorcade {
namespace {

geometry_msgs_msg_dds__Quaternion_ ddsQuaternion(const ros::Quaternion& q) {
  return {.x = q.x, .y = q.y, .z = q.z, .w = q.w};
}

std::int64_t nanosecondsOf(const builtin_interfaces_msg_dds__Time_& time) {
  return std::int64_t{time.sec} * 1'000'000'000 + time.nanosec;
}

std::string stringOf(const char* text) { return text == nullptr ? "" : text; }

template <class Sequence>
auto spanOf(const Sequence& sequence) {
  return std::span(sequence._buffer, sequence._length);
}

/// True where the pixels are not those of the whole sensor, one by one.
bool isReduced(const sensor_msgs_msg_dds__CameraInfo_& sample) {
  const auto& roi = sample.roi;
  const bool whole = (roi.width == 0 || roi.width == sample.width) && (roi.height == 0 || roi.height == sample.height);
  return sample.binning_x > 1 || sample.binning_y > 1 || roi.x_offset > 0 || roi.y_offset > 0 || !whole;
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

ImageMessage imageMessageOf(const sensor_msgs_msg_dds__Image_& sample) {
  return {.stamp_ns = nanosecondsOf(sample.header.stamp),
          .frame_id = stringOf(sample.header.frame_id),
          .width = sample.width,
          .height = sample.height,
          .encoding = stringOf(sample.encoding),
          .is_bigendian = sample.is_bigendian != 0,
          .step = sample.step,
          .data = spanOf(sample.data)};
}

CompressedImageMessage imageMessageOf(const sensor_msgs_msg_dds__CompressedImage_& sample) {
  return {.stamp_ns = nanosecondsOf(sample.header.stamp),
          .frame_id = stringOf(sample.header.frame_id),
          .format = stringOf(sample.format),
          .data = spanOf(sample.data)};
}

CameraInfoMessage cameraInfoMessageOf(const sensor_msgs_msg_dds__CameraInfo_& sample) {
  CameraInfoMessage message{.stamp_ns = nanosecondsOf(sample.header.stamp),
                            .frame_id = stringOf(sample.header.frame_id),
                            .width = sample.width,
                            .height = sample.height,
                            .distortion_model = stringOf(sample.distortion_model),
                            .reduced = isReduced(sample)};
  const auto coefficients = spanOf(sample.d);
  const auto kept = coefficients.first(std::min(coefficients.size(), kMostCoefficients + 1));
  message.D.assign(kept.begin(), kept.end());
  std::ranges::copy(sample.k, message.K.begin());
  std::ranges::copy(sample.r, message.R.begin());
  std::ranges::copy(sample.p, message.P.begin());
  return message;
}

VehicleMotion vehicleMotionOf(const geometry_msgs_msg_dds__TwistWithCovarianceStamped_& sample) {
  constexpr int kAlong = 0, kAboutUp = 35;  // of the covariance's diagonal
  const auto sigma = [&](int entry) {
    const double variance = sample.twist.covariance[entry];
    return std::isfinite(variance) && variance > 0 ? std::sqrt(variance) : 0.0;
  };
  return {.stamp_ns = nanosecondsOf(sample.header.stamp),
          .speed_mps = sample.twist.twist.linear.x,
          .yaw_rate_radps = sample.twist.twist.angular.z,
          .speed_sigma_mps = sigma(kAlong),
          .yaw_rate_sigma_radps = sigma(kAboutUp)};
}

}  // namespace motorcade
