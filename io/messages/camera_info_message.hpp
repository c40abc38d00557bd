#pragma once

#include <array>
#include <cstdint>
#include <string>
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

}  // namespace motorcade
