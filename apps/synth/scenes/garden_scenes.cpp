#include "apps/synth/scenes/garden_scenes.hpp"

#include <numbers>

#include "apps/synth/models/garden_model.hpp"
#include "apps/synth/models/street_model.hpp"
#include "apps/synth/scenes/scene_parts.hpp"

namespace motorcade::synth {
namespace {

constexpr double kGardenRoad_m = 40;  // behind the ego car's start

/// A fence or a hedge at an angle to the street, and the garden behind it.
void placeGarden(SceneBuilder& b, double along_m, double side, float length_m) {
  const double curb_m = side * b.scene.roads.roads()[0].half_width_m;
  const double turn_rad = b.random.uniform(-0.22F, 0.22F);
  const auto put = [&](Model model, double at_m, double out_m, double turn) {
    b.place(std::move(model), 0, along_m + at_m, curb_m + side * out_m, turn, 1.02);
  };
  if (b.random.chance(0.65F))
    put(makePicketFence(length_m, b.random.bits()), 0, 2.6, turn_rad);
  else
    put(makeHedge(length_m, b.random.uniform(0.8F, 1.7F), b.random.bits()), 0, 3.0, turn_rad);
  put(makeBush(b.random.uniform(1, 3), b.random.bits()), b.random.uniform(-3, 3), b.random.uniform(4.5F, 7), 0);
  put(makeTree(b.random.uniform(4.5F, 7), b.random.bits()), b.random.uniform(-4, 4), b.random.uniform(6, 9), 0);
  put(makeHedge(length_m + 2, b.random.uniform(1.6F, 2.2F), b.random.bits()), 0, 12, 0);
  if (b.random.chance(0.6F)) put(makeBuilding(9, 8, b.random.uniform(4, 7), b.random.bits()), 0, 17, 0.5 * turn_rad);
}

/// Trees along both curbs whose crowns hang over the parking spaces.
void plantAvenue(SceneBuilder& b, Model (*tree)(float height_m, std::uint32_t seed), double from_m, double to_m) {
  const double curb_m = b.scene.roads.roads()[0].half_width_m;
  for (const double side : {-1.0, 1.0})
    for (double along_m = from_m + (side > 0 ? 3.5 : 0); along_m < to_m; along_m += b.random.uniform(6, 8.5F))
      b.place(tree(b.random.uniform(5, 6.2F), b.random.bits()), 0, along_m, side * (curb_m + 0.8), 0, 0.4);
}

}  // namespace

void buildHedges(SceneBuilder& b) {
  b.scene.frames = 90;
  constexpr float kPlot_m = 10;
  const auto path =
      makePath(-kGardenRoad_m, 0, 0, {{50, 0}, {36, 0.5}, {20, 0}, {44, -0.7}, {30, 0}, {40, 0.4}, {90, 0}});
  b.setRoads({{path, 4.2, {{0, 0.12, true}}}});
  const double v = vary(b.random, 7.5, 0.04);
  b.setEgo(drive(path, kGardenRoad_m, v, -0.5 * kLane_m));
  b.addMover(VehicleKind::kCar, drive(path, kGardenRoad_m + 75, vary(b.random, 7, 0.05), 0.5 * kLane_m, true));
  for (const double side : {-1.0, 1.0}) {
    for (double along_m = 20; along_m < 300; along_m += kPlot_m + 0.8) placeGarden(b, along_m, side, kPlot_m);
    for (double along_m = side < 0 ? 20 : 36; along_m < 300; along_m += 32)
      b.place(makeLampPost(b.random.bits()), 0, along_m, side * 4.8, side < 0 ? std::numbers::pi : 0, 0.3);
  }
}

void buildWindy(SceneBuilder& b) {
  b.scene.frames = 90;
  const auto path = makePath(-kGardenRoad_m, 0, 0, {{110, 0}, {70, -0.2}, {140, 0}});
  b.setRoads({street(path)});
  const double v = vary(b.random, 8, 0.04);
  b.setEgo(drive(path, kGardenRoad_m, v, -0.5 * kLane_m));
  b.addMover(VehicleKind::kCar, drive(path, kGardenRoad_m + b.random.uniform(14, 17),
                                      Profile({{0, v}, {4, v + 0.6}, {9, v}}), -0.5 * kLane_m));
  plantAvenue(b, makeSwayingTree, 20, 280);
  b.dress(0, {.from_m = 20, .to_m = 300, .trees = false, .parked_share = 0.7, .smooth_share = 0.2});
}

void buildParked(SceneBuilder& b) {
  b.scene.frames = 90;
  const auto path = makePath(-kGardenRoad_m, 0, 0, {{70, 0}, {60, 0.2}, {50, 0}, {60, -0.2}, {80, 0}});
  b.setRoads({street(path)});
  b.setEgo(drive(path, kGardenRoad_m, vary(b.random, 8, 0.05), -0.5 * kLane_m));
  plantAvenue(b, makeTree, 20, 280);
  b.dress(0, {.from_m = 20, .to_m = 300, .trees = false, .parked_share = 0.97, .smooth_share = 0.4});
}

}  // namespace motorcade::synth
