#include "frontend/shape/point_extent.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

namespace motorcade {
namespace {

constexpr std::size_t kLeastPoints = 5, kLeastSure = 10;
constexpr std::size_t kStrayPart = 10, kOthersPart = 5;  // of the points, at each side: strays, or of another body
constexpr double kFarthest_m = 15;                       // of a point on an object from its body's origin
constexpr double kSigmas = 2;                            // of a point's depth

/// Places along each body axis.
using Places = std::array<std::vector<double>, 3>;

/// Box from the place below which a part of the first lies to the one above which a part of the last does.
Eigen::AlignedBox3d boxBetween(Places first, Places last, std::size_t part) {
  Eigen::AlignedBox3d box;
  const std::size_t left_out = first[0].size() / part;
  for (int axis = 0; axis < 3; ++axis) {
    std::ranges::sort(first[axis]);
    std::ranges::sort(last[axis]);
    box.min()[axis] = first[axis][left_out];
    box.max()[axis] = last[axis][last[axis].size() - 1 - left_out];
  }
  return box;
}

}  // namespace

PointExtent extentOf(const std::vector<PointMeasurement>& points, const StereoCamera& camera, const SE3& T_body_cam,
                     double disparity_offset_px) {
  Places middle, early, late;  // early and late by the noise of depth
  for (const PointMeasurement& p : points) {
    const Eigen::Vector3d uvd_px = p.uvd_px.cast<double>() + Eigen::Vector3d(0, 0, disparity_offset_px);
    if (uvd_px.z() <= 0) continue;
    const Eigen::Vector3d p_cam = camera.triangulate(uvd_px), p_body = T_body_cam * p_cam;
    if (p_body.norm() > kFarthest_m) continue;
    const Eigen::Vector3d noise_m = kSigmas * p.sigma_px.z() / uvd_px.z() * (T_body_cam.rotation() * p_cam).cwiseAbs();
    for (int axis = 0; axis < 3; ++axis) {
      middle[axis].push_back(p_body[axis]);
      early[axis].push_back(p_body[axis] - noise_m[axis]);
      late[axis].push_back(p_body[axis] + noise_m[axis]);
    }
  }
  PointExtent extent;
  const std::size_t count = middle[0].size();
  if (count >= kLeastPoints) extent.box = boxBetween(middle, middle, kStrayPart);
  if (count >= kLeastSure) extent.sure = boxBetween(std::move(late), std::move(early), kOthersPart);
  return extent;
}

Eigen::Vector3d SureSizes::add(const Eigen::Vector3d& size_m) {
  Eigen::Vector3d counts_m;
  for (int axis = 0; axis < 3; ++axis) {
    std::array<double, kFrames>& largest = largest_[axis];
    if (size_m[axis] > largest.back()) largest.back() = size_m[axis];
    std::ranges::sort(largest, std::greater{});
    counts_m[axis] = largest.back();
  }
  return counts_m;
}

}  // namespace motorcade
