#pragma once

#include <optional>

#include "apps/synth/scenes/frame_scene.hpp"

namespace motorcade::synth {

/// Road, curb and what lies beyond: asphalt at z = 0, everything off the roads one curb higher.
class Ground {
 public:
  static constexpr float kCurb_m = 0.12F;

  explicit Ground(const FrameScene& frame);

  struct Hit {
    float t = 0;
    Vec3 normal;
    RoadPosition where;
    Vec3 position_map;
    bool curb_face = false;
  };
  /// Largest parameter at which a ray can meet the ground: its crossing of the road's plane.
  float farthest(const Vec3& origin, const Vec3& direction) const {
    return direction.z > -kLevel ? 1e30F : (-camera_z_m_ - origin.z) / direction.z;
  }
  /// Point where a ray from the camera meets the ground, before t_max.
  std::optional<Hit> hit(const Vec3& origin, const Vec3& direction, float t_max) const;
  /// Reflectance at a hit, dry; `width_m` is that of a pixel across the ray.
  float reflectance(const Hit& hit, const Vec3& direction, float width_m) const;

 private:
  static constexpr float kLevel = 1e-5F;  // rays that fall less are taken as level
  struct View;
  float asphalt(const Hit& hit, const View& view) const;
  float paint(const Hit& hit, const View& view) const;
  float beside(const Hit& hit, const View& view) const;

  const Scene* scene_;
  double camera_x_m_, camera_y_m_;
  float camera_z_m_;
};

}  // namespace motorcade::synth
