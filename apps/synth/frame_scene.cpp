#include "apps/synth/frame_scene.hpp"

#include <cmath>

namespace motorcade::synth {
namespace {

Vec3 toFloat(const Eigen::Vector3d& v) { return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())}; }

Bounds boundsOf(const Primitive& part, const Placed& placed) {
  const Vec3 centre = (part.lo + part.hi) * 0.5F, half = (part.hi - part.lo) * 0.5F;
  const auto absolute = [](const Vec3& v) { return Vec3{std::abs(v.x), std::abs(v.y), std::abs(v.z)}; };
  const Vec3 c = placed.rotation * centre + placed.translation;
  const Vec3 h{dot(absolute(placed.rotation.row0), half), dot(absolute(placed.rotation.row1), half),
               dot(absolute(placed.rotation.row2), half)};
  const Vec3 slack{1e-4F, 1e-4F, 1e-4F};
  return {c - h - slack, c + h + slack};
}

/// Names the face: which way the normal points, roughly.
std::uint32_t faceOf(const Vec3& n) {
  const auto step = [](float x) { return static_cast<std::uint32_t>(std::lround(2 * x) + 2); };
  return step(n.x) + 5 * step(n.y) + 25 * step(n.z);
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
      place(mover.model, trajectory.T_map_body(t_s), mover.id, trajectory.speedAt_mps(t_s) > 0.05, driven / kWheelRadius_m);
    }
  std::vector<Bounds> boxes;
  for (std::uint32_t i = 0; i < placed_.size(); ++i)
    for (std::uint32_t k = 0; k < placed_[i].model->parts.size(); ++k) {
      items_.push_back({i, k});
      boxes.push_back(boundsOf(placed_[i].model->parts[k], placed_[i]));
    }
  bvh_.emplace(boxes);
}

void FrameScene::place(std::shared_ptr<const Model> model, const SE3& T_map_body, int id, bool moving, double wheel_angle_rad) {
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

std::optional<RayHit> FrameScene::firstHit(const Vec3& origin, const Vec3& direction, float t_max) const {
  std::optional<RayHit> best;
  bvh_->traverse(origin, direction, t_max, [&](std::uint32_t item, float limit) {
    const Placed& placed = placed_[items_[item].placed];
    const Primitive& part = placed.model->parts[items_[item].part];
    const Vec3 o = placed.rotation.transposed(origin - placed.translation), d = placed.rotation.transposed(direction);
    const auto hit = intersect(part, placed.model->cuts.data(), o, d, 1e-3F, limit);
    if (!hit) return limit;
    const bool round = part.shape != Shape::kBlock;
    best = RayHit{hit->t, &placed, &part, item * 128U + (round ? 0U : faceOf(hit->normal)), hit->normal, o + d * hit->t};
    return hit->t;
  });
  return best;
}

std::optional<RayHit> FrameScene::hitOn(const Placed& placed, const Vec3& origin, const Vec3& direction) const {
  const Vec3 o = placed.rotation.transposed(origin - placed.translation), d = placed.rotation.transposed(direction);
  std::optional<RayHit> best;
  for (const auto& part : placed.model->parts)
    if (const auto hit = intersect(part, placed.model->cuts.data(), o, d, 1e-3F, best ? best->t : 1e9F))
      best = RayHit{hit->t, &placed, &part, 0, hit->normal, o + d * hit->t};
  return best;
}

bool FrameScene::occluded(const Vec3& origin, const Vec3& direction, float t_max) const {
  bool blocked = false;
  bvh_->traverse(origin, direction, t_max, [&](std::uint32_t item, float limit) {
    const Placed& placed = placed_[items_[item].placed];
    const Vec3 o = placed.rotation.transposed(origin - placed.translation), d = placed.rotation.transposed(direction);
    blocked = intersect(placed.model->parts[items_[item].part], placed.model->cuts.data(), o, d, 2e-3F, limit).has_value();
    return blocked ? -1.0F : limit;
  });
  return blocked;
}

}  // namespace motorcade::synth
