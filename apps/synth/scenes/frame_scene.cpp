#include "apps/synth/scenes/frame_scene.hpp"

#include <cmath>

namespace motorcade::synth {
namespace {

Vec3 toFloat(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

constexpr float kWheelRadius_m = 0.33F;

}  // namespace

FrameScene::FrameScene(const Scene& scene, int frame, bool with_movers) : scene_(&scene), frame_(frame) {
  const double t_s = scene.time_s(frame);
  T_map_cam_ = scene.ego.T_map_cam(t_s);
  for (const auto& fixture : scene.fixtures) {
    const double distance_m = (fixture.T_map_body.translation() - T_map_cam_.translation()).norm();
    if (distance_m < 260)
      place({.model = fixture.model, .T_map_body = fixture.T_map_body, .id = fixture.id},
            fixture.model->sways ? t_s : 0);
  }
  if (scene.ego.bonnet) place({.model = scene.ego.bonnet, .T_map_body = scene.ego.T_map_bonnet(t_s)}, 0);
  if (with_movers)
    for (const auto& mover : scene.movers) {
      const auto& trajectory = mover.trajectory;
      place({.model = mover.model,
             .T_map_body = trajectory.T_map_body(t_s),
             .id = mover.id,
             .moving = trajectory.speedAt_mps(t_s) > 0.05},
            std::abs(trajectory.arc_m(t_s) - trajectory.start_m));
    }
  for (std::uint32_t i = 0; i < placed_.size(); ++i)
    for (std::uint32_t k = 0; k < placed_[i].model->parts.size(); ++k) items_.push_back({i, k});
}

void FrameScene::place(Placed placed, double driven_m) {
  const auto& R = placed.T_map_body.rotation();
  placed.rotation = {toFloat(R.row(0)), toFloat(R.row(1)), toFloat(R.row(2))};
  placed.translation = toFloat(placed.T_map_body.translation() - T_map_cam_.translation());
  placed.wheel_angle_rad = static_cast<float>(std::remainder(driven_m / kWheelRadius_m, 2 * M_PI));
  placed_.push_back(placed);
  for (const Limb& limb : placed.model->limbs) {
    Placed part = placed;
    part.model = limb.model;
    part.T_map_body = placed.T_map_body * limb.T_parent_limb(driven_m);
    part.limb = true;
    place(std::move(part), driven_m);
  }
}

std::vector<std::span<const Placed>> FrameScene::objects() const {
  std::vector<std::span<const Placed>> objects;
  for (std::size_t first = 0, end = 0; first < placed_.size(); first = end) {
    for (end = first + 1; end < placed_.size() && placed_[end].limb;) ++end;
    if (placed_[first].id >= 0) objects.push_back(std::span(placed_).subspan(first, end - first));
  }
  return objects;
}

bool FrameScene::meets(std::span<const Placed> thing, const Vec3& direction) {
  return std::any_of(thing.begin(), thing.end(), [&](const Placed& placed) {
    const Vec3 o = placed.rotation.transposed(placed.translation * -1), d = placed.rotation.transposed(direction);
    const auto& parts = placed.model->parts;
    return std::any_of(parts.begin(), parts.end(), [&](const Primitive& part) {
      return intersect(part, placed.model->cuts.data(), o, d, 1e-3F, 1e9F).has_value();
    });
  });
}

}  // namespace motorcade::synth
