#pragma once

#include <memory>
#include <vector>

#include "core/se3.hpp"
#include "frontend/features/feature_preparation.hpp"
#include "frontend/motion/coarse_localization.hpp"
#include "tests/frontend/texture.hpp"
#include "tests/frontend/two_surfaces.hpp"

namespace motorcade::test {

/// A wall 30 m ahead with a texture, as a stereo camera sees it from wherever it is, and points on it.
class WallWithPoints {
 public:
  explicit WallWithPoints(unsigned seed) : texture_(seed, 12, 160) {}

  /// The features of a pair that was taken at T_wall_cam.
  FeaturesPtr seenFrom(const SE3& T_wall_cam, int frame) const {
    const SE3 T_left_right(Eigen::Matrix3d::Identity(), {kSmallRig.baseline_m, 0, 0});
    return prepare_(stereoFrame(frame, image(T_wall_cam, frame), image(T_wall_cam * T_left_right, 100 + frame)));
  }

  /// Points on a grid, as seen from where the wall's coordinates begin.
  std::vector<RestingPoint> points() const {
    std::vector<RestingPoint> points;
    for (int v = 20; v < kSmallRig.height_px - 20; v += 12)
      for (int u = 20; u < kSmallRig.width_px - 20; u += 12) {
        const Eigen::Vector3d uvd_px(u, v, kSmallRig.fx_px * kSmallRig.baseline_m / kDepth_m);
        points.push_back({.point = {static_cast<std::int64_t>(points.size())},
                          .uvd_px = uvd_px,
                          .p_cam = kSmallRig.triangulate(uvd_px),
                          .observations = 5});
      }
    return points;
  }

 private:
  static constexpr double kDepth_m = 30, kTexels_per_m = 10;

  Image image(const SE3& T_wall_cam, int seed) const {
    const auto gray = [&](double u, double v) {
      const Eigen::Vector3d ray = T_wall_cam.rotation() * Eigen::Vector3d((u - kSmallRig.cx_px) / kSmallRig.fx_px,
                                                                          (v - kSmallRig.cy_px) / kSmallRig.fy_px, 1);
      const Eigen::Vector3d& t = T_wall_cam.translation();
      const Eigen::Vector3d p = t + (kDepth_m - t.z()) / ray.z() * ray;
      return texture_(kTexels_per_m * p.x(), kTexels_per_m * p.y());
    };
    return render(kSmallRig.width_px, kSmallRig.height_px, gray,
                  {.gain = 0.9, .noise = 1, .seed = static_cast<unsigned>(seed)});
  }

  Texture texture_;
  FeaturePreparation prepare_{{}};
};

}  // namespace motorcade::test
