#include "apps/synth/scenes/bonnet_scene.hpp"

#include "apps/synth/scenes/scene_parts.hpp"

namespace motorcade::synth {
namespace {

/// Fills the lowest 60 rows or so of KITTI's images. The cameras sit behind the windshield, left and right of its
/// middle.
Model makeBonnet(std::uint32_t seed) {
  constexpr float kMiddle_m = -0.27F;  // half the baseline
  Model m;
  m.smooth_paint = true;
  m.addEllipsoid(Material::kBonnet, {0.6F, kMiddle_m, -0.70F}, {1.5F, 1.15F, 0.5F}, 0.03F, seed);
  return m;
}

}  // namespace

void buildBonnet(SceneBuilder& b) {
  b.scene.frames = 100;
  constexpr double kApproach_m = 40, kCamera_m = 1.35;
  const auto path = makePath(-kApproach_m, 0, 0, {{70, 0}, {60, 0.25}, {50, 0}, {70, -0.3}, {110, 0}});
  b.setRoads({street(path)});
  b.scene.ego.camera_height_m = kCamera_m;
  b.scene.ego.bonnet = std::make_shared<const Model>(makeBonnet(b.random.bits()));
  const double v = vary(b.random, 10, 0.04);
  b.setEgo(drive(path, kApproach_m, v, -0.5 * kLane_m));
  b.addMover(VehicleKind::kCar, drive(path, kApproach_m + b.random.uniform(15, 18),
                                      Profile({{0, v}, {4, v + 1}, {9, v - 0.5}}), -0.5 * kLane_m));
  b.addMover(VehicleKind::kCar, drive(path, kApproach_m + 90, vary(b.random, 9, 0.05), 0.5 * kLane_m, true));
  b.addMover(VehicleKind::kVan, drive(path, kApproach_m + 150, vary(b.random, 9, 0.05), 0.5 * kLane_m, true));
  b.dress(0, {.from_m = 20, .to_m = 350, .parked_share = 0.4, .smooth_share = 0.2});
}

}  // namespace motorcade::synth
