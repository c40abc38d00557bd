#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/ids.hpp"
#include "core/messages.hpp"

namespace motorcade {

/// One line of a KITTI tracking label file. A `DontCare` line has a box only.
struct Label {
  FrameId frame;
  std::int64_t track = -1;
  std::string type;      // Car, Van, Pedestrian, ... or DontCare
  double truncated = 0;  // 0 ... 1, or the levels 0, 1, 2 of the tracking set
  int occluded = 0;      // 0 visible, 1 partly, 2 largely occluded, 3 unknown
  Box box;
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();      // height, width, length
  Eigen::Vector3d location_m = Eigen::Vector3d::Zero();  // center of the bottom face, in the rectified left gray camera
  double rotation_y_rad = 0;                             // about the camera's y axis

  bool dontCare() const { return type == "DontCare"; }
};

/// Reads a label file, or a result file, whose scores are passed over. Throws InputError naming the line. Keeps the
/// file's order.
std::vector<Label> readLabels(const std::filesystem::path& file);

/// A line of a KITTI tracking result file, without its end: the 17 columns of a label and a score. Truncation and
/// occlusion, which results do not need, are -1. The observation angle alpha is computed from the rest.
std::string resultLine(const Label& label, double score);

}  // namespace motorcade
