#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "io/rig/rectification.hpp"

/// Calibrations of pairs that are not rectified, told apart by their content:
///   Kalibr   a camchain with cam0 (left) and cam1 (right), T_cn_cnm1 between them
///   ROS      camera_info of the left camera and of the right one, a file each; rectified as they say
///   OpenCV   intrinsics M1 D1 M2 D2 and extrinsics R T, in one file or two
namespace motorcade {

/// One file, or two that belong together. Throws InputError naming file, line and key.
Rig readRig(const std::vector<std::filesystem::path>& files);

/// Of EuRoC's `cam0/sensor.yaml` and `cam1/sensor.yaml`.
Rig readEurocRig(const std::filesystem::path& left, const std::filesystem::path& right);
/// From the left camera to the body that such a file places it on.
SE3 readEurocPlacement(const std::filesystem::path& sensor_file);

/// The calibration files that lie in a folder under their usual names; empty where there are none.
std::vector<std::filesystem::path> usualRigFiles(const std::filesystem::path& folder);

}  // namespace motorcade
