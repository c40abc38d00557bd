#pragma once

#include <filesystem>
#include <vector>

#include "io/files/errors.hpp"
#include "io/rig/rectification.hpp"

/// Calibrations of pairs in makers' forms, told apart by their content: Kalibr's chains, ROS' camera_info, OpenCV's
/// matrices, EuRoC's sensor files, settings of visual SLAM systems and others (rig_readers.hpp).
namespace motorcade {

/// A file that is no calibration of a known form.
struct UnknownCalibration : InputError {
  using InputError::InputError;
};

/// One file, or two that belong together. Throws InputError naming file, line and key.
Rig readRig(const std::vector<std::filesystem::path>& files);

/// Reads EuRoC's `cam0/sensor.yaml` and `cam1/sensor.yaml`.
Rig readEurocRig(const std::filesystem::path& left, const std::filesystem::path& right);
/// Reads the transform from the left camera to the body on which such a file places it.
SE3 readEurocPlacement(const std::filesystem::path& sensor_file);

}  // namespace motorcade
