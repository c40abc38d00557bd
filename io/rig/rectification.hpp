#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/se3.hpp"
#include "core/stereo_camera.hpp"
#include "io/rig/lens_camera.hpp"

namespace motorcade {

/// The geometry that turns two raw images into a rectified pair.
struct Rectification {
  LensCamera left, right;
  Eigen::Matrix3d R_left = Eigen::Matrix3d::Identity();  // p_rectified = R * p_raw, of each camera
  Eigen::Matrix3d R_right = Eigen::Matrix3d::Identity();
  StereoCamera camera{};  // what takes the rectified pair
};

/// Two cameras as a calibration describes them.
struct Rig {
  std::filesystem::path file{};  // that tells, for messages
  LensCamera left{}, right{};
  SE3 T_right_left{};
  std::optional<Rectification> given{};        // where the calibration also tells how to rectify
  std::optional<StereoCamera> rectified{};     // where the images are rectified already; then nothing else counts
  std::string transform{};                     // the key that T_right_left comes from, for messages
  std::string remark{};                        // what was taken of several cameras
  std::vector<std::filesystem::path> files{};  // all that were read
};

/// The rectification that the calibration gives, else our own. Both cameras turn until their x axes lie along the
/// baseline. Their z axes lie along the mean of both viewing directions as far as that allows. The focal length is the
/// shortest at which both images fill the frame, but at least `kLeastZoom` of the cameras'. The rectified images are as
/// large as the raw ones. Throws InputError naming the file.
Rectification rectificationOf(const Rig& rig, ImageSize size);

/// Least zoom of the rectified pair. A very wide lens loses its edges rather than the resolution in the middle.
inline constexpr double kLeastZoom = 0.7;

}  // namespace motorcade
