#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "core/se3.hpp"
#include "core/stereo_camera.hpp"
#include "io/images/image_file.hpp"

namespace motorcade {

/// The pair of KITTI's four cameras that a sequence uses: 0 and 1 are gray, 2 and 3 color.
enum class CameraPair { kGray, kColor };

/// The content of a KITTI calibration, whatever its spelling. What the file does not give is empty.
struct Calibration {
  using Projection = Eigen::Matrix<double, 3, 4>;
  std::filesystem::path file{};
  std::array<std::optional<Projection>, 4> P{};  // P0 ... P3, after rectification [px]
  std::array<int, 4> line_of_P{};                // counted from one, for messages; 0 when it came from no file
  std::optional<Eigen::Matrix3d> R_rect{};       // unrectified to rectified camera 0
  std::optional<SE3> T_cam_velo{};               // the unrectified camera 0
  std::optional<SE3> T_velo_imu{};
  std::array<std::optional<ImageSize>, 4> size{};  // of the rectified images, where the file tells
  std::optional<CalibrationSigmas> sigmas{};       // how exact it is
  std::string advice{};                            // what the file seems to be where it has no projection

  /// The pair's intrinsics and baseline (image size left open); throws InputError naming the key.
  StereoCamera stereoCamera(CameraPair pair) const;
  /// The column of the right image's principal point; that of the left one where both are the same [px].
  double rightMiddle_px(CameraPair pair) const;
  std::optional<ImageSize> rectifiedSize(CameraPair pair) const;
  /// Transform from the rectified left gray camera, the frame of labels and poses, to the pair's left camera.
  SE3 T_left_cam0(CameraPair pair) const;
  /// Transform from the inertial unit to the rectified left gray camera. Empty when a part of the chain is missing.
  std::optional<SE3> T_cam0_imu() const;
};

/// Reads `calib.txt` of the plain, tracking and odometry layouts, in both spellings of its keys, and Middlebury's.
Calibration readCalibration(const std::filesystem::path& file);

/// Reads `calib_cam_to_cam.txt` of a raw date folder and, where they are there, `calib_velo_to_cam.txt` and
/// `calib_imu_to_velo.txt`.
Calibration readRawCalibration(const std::filesystem::path& date_folder);

}  // namespace motorcade
