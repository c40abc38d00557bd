#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "core/messages.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// Box around the points of an object, in its body frame, without the outermost tenth at each side. Empty where they
/// are fewer than five.
std::optional<Eigen::AlignedBox3d> extentOf(const std::vector<PointMeasurement>& points, const StereoCamera& camera,
                                            const SE3& T_body_cam, double disparity_offset_px);

/// What the body surely reaches over: the box without the outermost fifth at each side, less two standard deviations of
/// the points' depth. Its least corner is beyond its most one along axes of which noise leaves nothing. Empty where the
/// points are fewer than ten.
std::optional<Eigen::AlignedBox3d> sureExtentOf(const std::vector<PointMeasurement>& points, const StereoCamera& camera,
                                                const SE3& T_body_cam, double disparity_offset_px);

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
