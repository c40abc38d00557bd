#pragma once

#include <optional>
#include <span>

#include "io/files/errors.hpp"
#include "io/rig/rectification.hpp"
#include "io/rig/yaml_file.hpp"

/// Readers of the makers' forms of a calibration, given as one file or as two, the left camera's first. Each returns a
/// rig if the files are of its form, and nothing otherwise. Throws InputError for files of its form that cannot be
/// used.
namespace motorcade {

using RigParts = std::span<const YamlPart>;

/// A calibration of only one camera of the pair.
struct OneCameraError : InputError {
  using InputError::InputError;
};

/// Kalibr's and OpenVINS' chains: cam0, cam1, and the transform between them, or of both to the inertial unit.
std::optional<Rig> kalibrRig(RigParts files);
/// ROS' camera_info of both cameras, in two files or as `left` and `right` of one.
std::optional<Rig> rosRig(RigParts files);
/// OpenCV's M1 D1 M2 D2 R T, in one file or two.
std::optional<Rig> openCvRig(RigParts files);
/// Cameras placed on a body: EuRoC's and Kimera's sensor files, OKVIS' and maplab's lists, Basalt's JSON.
std::optional<Rig> placedRig(RigParts files);
/// Settings of ORB-SLAM and stella_vslam.
std::optional<Rig> slamRig(RigParts files);
/// VINS-Fusion's configuration, which names a file for each camera.
std::optional<Rig> vinsRig(RigParts files);
/// Focal lengths, middle and baseline of a rectified pair: Cityscapes' JSON.
std::optional<Rig> rectifiedRig(RigParts files);

/// One of EuRoC's sensor files: from the camera to the body.
SE3 sensorPlacement(const YamlPart& sensor);

}  // namespace motorcade
