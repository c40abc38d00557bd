#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/rig/rectification.hpp"

namespace motorcade {

/// ROS' sensor_msgs/CameraInfo, with ROS' names of the matrices, row by row.
struct CameraInfoMessage {
  std::int64_t stamp_ns = 0;
  std::string frame_id{};
  std::uint32_t width = 0, height = 0;
  std::string distortion_model{};
  std::vector<double> D{};
  std::array<double, 9> K{}, R{};
  std::array<double, 12> P{};
  bool reduced = false;  // the images are binned, or a region of the sensor's
};

/// The most coefficients of a distortion model. A receiver refuses a message with more.
inline constexpr std::size_t kMostCoefficients = 14;

/// The messages of a pair, with names for the user, as the topics.
struct CameraInfoPair {
  CameraInfoMessage left{}, right{};
  std::string left_name{}, right_name{};
};

/// The rig that both messages describe; the right one's P has the baseline. Images that were rectified before they were
/// sent, by `rectified`, use P alone. `Rig::rectified` is set where nothing is left to be done. Throws InputError
/// naming the message.
Rig rigOf(const CameraInfoPair& infos, bool rectified);

// ROS' conventions for the names of a camera's topics.

/// True for images that were rectified before they were sent: `image_rect`, `image_rect_color`, ..., also compressed.
/// Their camera_info still describes the raw images.
bool isRectifiedTopic(std::string_view image_topic);

/// The camera_info beside an image topic: `/left/camera_info` of `/left/image_raw` and `/left/image_raw/compressed`.
std::string cameraInfoTopicOf(std::string_view image_topic);

}  // namespace motorcade
