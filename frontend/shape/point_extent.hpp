#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "core/messages.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// Boxes around the points of an object, in its body frame.
struct PointExtent {
  /// The box leaves out the outermost tenth of the points at each side. It is empty if there are fewer than five.
  std::optional<Eigen::AlignedBox3d> box;
  /// The body surely reaches over this box. It leaves out the outermost fifth at each side, and two standard deviations
  /// of the points' depth. Where noise leaves nothing of an axis, its least corner is beyond its most one. It is empty
  /// if there are fewer than ten points.
  std::optional<Eigen::AlignedBox3d> sure;
};
PointExtent extentOf(const std::vector<PointMeasurement>& points, const StereoCamera& camera, const SE3& T_body_cam,
                     double disparity_offset_px);

/// Sizes that a body has at least. Points of another body join it now and then for a frame or two, so a size counts
/// that five frames reach.
class SureSizes {
 public:
  /// Adds the sizes of one frame's sure extent, and returns those that count; zero before the fifth.
  Eigen::Vector3d add(const Eigen::Vector3d& size_m);

 private:
  static constexpr std::size_t kFrames = 5;
  std::array<std::array<double, kFrames>, 3> largest_{};  // of each axis, the largest first
};

}  // namespace motorcade
