#pragma once

#include <memory>
#include <span>
#include <vector>

#include "apps/synth/scenes/scene.hpp"

namespace motorcade::synth {

/// A thing or a limb of one at one moment, placed relative to the left camera.
struct Placed {
  std::shared_ptr<const Model> model;
  SE3 T_map_body;
  Rotation rotation{};  // body axes to map axes
  Vec3 translation{};   // from the left camera, in map axes
  int id = -1;
  bool moving = false;  // faster than walking away from a standstill: 0.05 m/s
  bool limb = false;    // belongs to the nearest thing before it that is no limb
  float wheel_angle_rad = 0;
};

/// The scene at the time of one frame. Ray coordinates: map axes, origin at the left camera.
class FrameScene {
 public:
  FrameScene(const Scene& scene, int frame, bool with_movers);

  const Scene& scene() const { return *scene_; }
  int frame() const { return frame_; }
  const SE3& T_map_cam() const { return T_map_cam_; }
  /// Each thing is followed by its limbs.
  const std::vector<Placed>& placed() const { return placed_; }
  /// The things that carry an id, each with its limbs.
  std::vector<std::span<const Placed>> objects() const;

  /// Every part of every placed thing.
  struct Item {
    std::uint32_t placed = 0, part = 0;
  };
  const std::vector<Item>& items() const { return items_; }
  const Placed& placedOf(std::uint32_t item) const { return placed_[items_[item].placed]; }
  const Primitive& partOf(std::uint32_t item) const { return placedOf(item).model->parts[items_[item].part]; }

  /// True if the left camera's ray meets the thing, also where another thing hides it.
  static bool meets(std::span<const Placed> thing, const Vec3& direction);

 private:
  /// Completes a thing that has a model, pose and id, and adds it with its limbs.
  void place(Placed placed, double driven_m);

  const Scene* scene_;
  int frame_;
  SE3 T_map_cam_;
  std::vector<Placed> placed_;
  std::vector<Item> items_;
};

}  // namespace motorcade::synth
