#include "frontend/shape/point_extent.hpp"

#include <algorithm>
#include <array>
#include <functional>

namespace motorcade {
namespace {

constexpr std::size_t kLeastPoints = 5, kLeastSure = 10;
constexpr std::size_t kStrayPart = 10, kOthersPart = 5;  // of the points, at each side: strays, or of another body
constexpr double kFarthest_m = 15;                       // of a point on an object from its body's origin
constexpr double kSigmas = 2;                            // of a point's depth

/// Places of points along each body axis, moved inwards and outwards by the noise of their depth.
struct Places {
  std::array<std::vector<double>, 3> middle, early, late;
};

Places placesOf(const std::vector<PointMeasurement>& points, const StereoCamera& camera, const SE3& T_body_cam,
                double disparity_offset_px) {
  Places places;
  for (const PointMeasurement& p : points) {
    const Eigen::Vector3d uvd_px = p.uvd_px.cast<double>() + Eigen::Vector3d(0, 0, disparity_offset_px);
    if (uvd_px.z() <= 0) continue;
    const Eigen::Vector3d p_cam = camera.triangulate(uvd_px), p_body = T_body_cam * p_cam;
    if (p_body.norm() > kFarthest_m) continue;
    const Eigen::Vector3d noise_m = kSigmas * p.sigma_px.z() / uvd_px.z() * (T_body_cam.rotation() * p_cam).cwiseAbs();
    for (int axis = 0; axis < 3; ++axis) {
      places.middle[axis].push_back(p_body[axis]);
      places.early[axis].push_back(p_body[axis] - noise_m[axis]);
      places.late[axis].push_back(p_body[axis] + noise_m[axis]);
    }
  }
  return places;
}

/// The value below which a part of them lies, or above.
double lowest(std::vector<double>& values, std::size_t part) {
  std::ranges::sort(values);
  return values[values.size() / part];
}
double highest(std::vector<double>& values, std::size_t part) {
  std::ranges::sort(values);
  return values[values.size() - 1 - values.size() / part];
}

}  // namespace

std::optional<Eigen::AlignedBox3d> extentOf(const std::vector<PointMeasurement>& points, const StereoCamera& camera,
                                            const SE3& T_body_cam, double disparity_offset_px) {
  Places places = placesOf(points, camera, T_body_cam, disparity_offset_px);
  if (places.middle[0].size() < kLeastPoints) return std::nullopt;
  Eigen::AlignedBox3d box;
  for (int axis = 0; axis < 3; ++axis) {
    box.min()[axis] = lowest(places.middle[axis], kStrayPart);
    box.max()[axis] = highest(places.middle[axis], kStrayPart);
  }
  return box;
}

std::optional<Eigen::AlignedBox3d> sureExtentOf(const std::vector<PointMeasurement>& points, const StereoCamera& camera,
                                                const SE3& T_body_cam, double disparity_offset_px) {
  Places places = placesOf(points, camera, T_body_cam, disparity_offset_px);
  if (places.middle[0].size() < kLeastSure) return std::nullopt;
  Eigen::AlignedBox3d box;
  for (int axis = 0; axis < 3; ++axis) {
    box.min()[axis] = lowest(places.late[axis], kOthersPart);
    box.max()[axis] = highest(places.early[axis], kOthersPart);
  }
  return box;
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
