#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "frontend/shape/outline.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade::test {

/// A cuboid on a flat road before a far wall, seen without error: each pixel shows one of them, at a known distance.
class StreetByHand {
 public:
  static constexpr double kRoad_m = 1.65, kWall_m = 60;
  struct Item {
    SE3 T_cam_body;
    BoxFaces faces;
  };
  explicit StreetByHand(std::vector<Item> items) : items_(std::move(items)) {}

  /// Body axes x ahead, y left, z up for a vehicle that heads along the camera's z axis, turned by `yaw_rad` to the
  /// left; its origin on the road at (x, z).
  static SE3 standingAt(double x_m, double z_m, double yaw_rad = 0) {
    Eigen::Matrix3d upright;
    upright << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    return {upright * expSO3({0, 0, yaw_rad}), {x_m, kRoad_m, z_m}};
  }
  static BoxFaces faces(const Eigen::Vector3d& size_m) {
    BoxFaces faces;
    faces << -size_m.x() / 2, size_m.x() / 2, -size_m.y() / 2, size_m.y() / 2, 0, size_m.z();
    return faces;
  }

  struct Hit {
    int item = -1;  // -1 road or wall
    double depth_m = kWall_m;
  };
  Hit at(double u_px, double v_px) const {
    const Eigen::Vector3d ray((u_px - kRig.cx_px) / kRig.fx_px, (v_px - kRig.cy_px) / kRig.fy_px, 1);
    Hit hit;
    if (ray.y() > 0) hit.depth_m = std::min(kWall_m, kRoad_m / ray.y());
    for (std::size_t i = 0; i < items_.size(); ++i)
      if (const double entry = entryOf(items_[i], ray); entry < hit.depth_m) hit = {static_cast<int>(i), entry};
    return hit;
  }
  LevelDisparities disparities(const PixelWindow& window, int level) const {
    LevelDisparities seen{.level = level, .map = {.window = window, .disparity_px = {}}};
    for (int row = 0; row < window.height; ++row)
      for (int column = 0; column < window.width; ++column)
        seen.map.disparity_px.push_back(static_cast<float>(
            kRig.fx_px * kRig.baseline_m / at(seen.u_px(column), seen.v_px(row)).depth_m / (1 << level)));
    return seen;
  }

 private:
  static double entryOf(const Item& item, const Eigen::Vector3d& ray) {
    const Eigen::Matrix3d R = item.T_cam_body.rotation().transpose();
    const Eigen::Vector3d origin = -R * item.T_cam_body.translation(), direction = R * ray;
    double begin = 0, end = std::numeric_limits<double>::max();
    for (int axis = 0; axis < 3; ++axis) {
      double in = (item.faces[2 * axis] - origin[axis]) / direction[axis],
             out = (item.faces[2 * axis + 1] - origin[axis]) / direction[axis];
      if (in > out) std::swap(in, out);
      begin = std::max(begin, in), end = std::min(end, out);
    }
    return begin < end ? begin : std::numeric_limits<double>::max();
  }

  std::vector<Item> items_;
};

inline Outline outlineOf(const LevelDisparities& seen, const ObjectView& view) {
  return findOutline(seen, cellsInReach(seen, view, kRig), view, kRig);
}

}  // namespace motorcade::test
