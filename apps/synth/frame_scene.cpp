#include "apps/synth/frame_scene.hpp"

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
    if (distance_m < 260) place(fixture.model, fixture.T_map_body, fixture.id, false, 0);
  }
  if (with_movers)
    for (const auto& mover : scene.movers) {
      const auto& trajectory = mover.trajectory;
      const double driven = std::abs(trajectory.arc_m(t_s) - trajectory.start_m);
      place(mover.model, trajectory.T_map_body(t_s), mover.id, trajectory.speedAt_mps(t_s) > 0.05,
            driven / kWheelRadius_m);
    }
  for (std::uint32_t i = 0; i < placed_.size(); ++i)
    for (std::uint32_t k = 0; k < placed_[i].model->parts.size(); ++k) items_.push_back({i, k});
}

void FrameScene::place(std::shared_ptr<const Model> model, const SE3& T_map_body, int id, bool moving,
                       double wheel_angle_rad) {
  const auto& R = T_map_body.rotation();
  Placed placed;
  placed.model = std::move(model);
  placed.T_map_body = T_map_body;
  placed.rotation = {toFloat(R.row(0)), toFloat(R.row(1)), toFloat(R.row(2))};
  placed.translation = toFloat(T_map_body.translation() - T_map_cam_.translation());
  placed.id = id;
  placed.moving = moving;
  placed.wheel_angle_rad = static_cast<float>(std::remainder(wheel_angle_rad, 2 * M_PI));
  placed_.push_back(std::move(placed));
}

bool FrameScene::meets(const Placed& placed, const Vec3& direction) {
  const Vec3 o = placed.rotation.transposed(placed.translation * -1), d = placed.rotation.transposed(direction);
  const auto& parts = placed.model->parts;
  return std::any_of(parts.begin(), parts.end(), [&](const Primitive& part) {
    return intersect(part, placed.model->cuts.data(), o, d, 1e-3F, 1e9F).has_value();
  });
}

}  // namespace motorcade::synth
