#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "apps/synth/bvh.hpp"
#include "apps/synth/scene.hpp"

namespace motorcade::synth {

/// A vehicle or a fixture at one moment, placed relative to the left camera.
struct Placed {
  std::shared_ptr<const Model> model;
  SE3 T_map_body;
  Rotation rotation;  // body axes to map axes
  Vec3 translation;   // from the left camera, in map axes
  int id = -1;
  bool moving = false;  // faster than walking away from a standstill: 0.05 m/s
  float wheel_angle_rad = 0;
};

/// What a ray meets first.
struct RayHit {
  float t = 0;
  const Placed* placed = nullptr;
  const Primitive* part = nullptr;
  std::uint32_t surface = 0;  // one number per flat or round piece of surface
  Vec3 normal_body, position_body;
};

/// The scene at the time of one frame. Ray coordinates: map axes, origin at the left camera.
class FrameScene {
 public:
  FrameScene(const Scene& scene, int frame, bool with_movers);

  const Scene& scene() const { return *scene_; }
  int frame() const { return frame_; }
  const SE3& T_map_cam() const { return T_map_cam_; }
  const std::vector<Placed>& placed() const { return placed_; }

  std::optional<RayHit> firstHit(const Vec3& origin, const Vec3& direction, float t_max) const;
  /// The first hit on one thing, whatever hides it.
  std::optional<RayHit> hitOn(const Placed& placed, const Vec3& origin, const Vec3& direction) const;
  /// Light that arrives along `direction`: 1 or 0.
  bool occluded(const Vec3& origin, const Vec3& direction, float t_max) const;

 private:
  struct Item {
    std::uint32_t placed = 0, part = 0;
  };
  void place(std::shared_ptr<const Model> model, const SE3& T_map_body, int id, bool moving, double wheel_angle_rad);

  const Scene* scene_;
  int frame_;
  SE3 T_map_cam_;
  std::vector<Placed> placed_;
  std::vector<Item> items_;
  std::optional<Bvh> bvh_;
};

}  // namespace motorcade::synth
