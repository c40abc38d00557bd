#pragma once

#include <vector>

#include <Eigen/Core>

#include "apps/synth/rendering/renderer.hpp"

/// Camera and rays that the tests of rendered scenes share.
namespace motorcade::synth {

/// A third of KITTI's images, so that scenes are quickly rendered.
inline const StereoCamera kSmallCamera = kittiCamera(414, 125);

constexpr RenderOptions kNoNoise{.threads = 2, .noise_levels = 0, .equal_gains = true};

inline std::vector<std::uint8_t> pixels(const Image& image) {
  std::vector<std::uint8_t> all;
  for (int y = 0; y < image.height(); ++y) all.insert(all.end(), image.row(y), image.row(y) + image.width());
  return all;
}

inline std::vector<Eigen::Vector2d> pixelsOf(const Rendering& rendering, const StereoCamera& camera, int object) {
  std::vector<Eigen::Vector2d> pixels;
  for (int y = 0; y < camera.height_px; ++y)
    for (int x = 0; x < camera.width_px; ++x)
      if (rendering.object[y * camera.width_px + x] == object) pixels.emplace_back(x, y);
  return pixels;
}

/// Distance at which a ray meets the nearest of all parts, tried one by one; t_max if none.
inline float nearestOfAll(const FrameScene& frame, const Vec3& origin, const Vec3& direction, float t_min,
                          float t_max) {
  for (std::uint32_t i = 0; i < frame.items().size(); ++i) {
    const Placed& placed = frame.placedOf(i);
    const Vec3 o = placed.rotation.transposed(origin - placed.translation), d = placed.rotation.transposed(direction);
    if (const auto hit = intersect(frame.partOf(i), placed.model->cuts.data(), o, d, t_min, t_max)) t_max = hit->t;
  }
  return t_max;
}

}  // namespace motorcade::synth
