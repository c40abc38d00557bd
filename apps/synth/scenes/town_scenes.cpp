#include <numbers>

#include "apps/synth/models/models.hpp"
#include "apps/synth/scenes/scene_builder.hpp"
#include "apps/synth/scenes/scene_kinds.hpp"

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
    put(b.drawHedge(length_m, 0.8F, 1.7F), 0, 3.0, turn_rad);
  const double bush_out_m = b.random.uniform(4.5F, 7), bush_at_m = b.random.uniform(-3, 3);
  put(b.drawPlant(makeBush, 1, 3), bush_at_m, bush_out_m, 0);
  const double tree_out_m = b.random.uniform(6, 9), tree_at_m = b.random.uniform(-4, 4);
  put(b.drawPlant(makeTree, 4.5F, 7), tree_at_m, tree_out_m, 0);
  put(b.drawHedge(length_m + 2, 1.6F, 2.2F), 0, 12, 0);
  if (!b.random.chance(0.6F)) return;
  const std::uint32_t house = b.random.bits();
  put(makeBuilding(9, 8, b.random.uniform(4, 7), house), 0, 17, 0.5 * turn_rad);
}

/// Trees along both curbs whose crowns hang over the parking spaces.
void plantAvenue(SceneBuilder& b, SceneBuilder::Plant tree, double from_m, double to_m) {
  const double curb_m = b.scene.roads.roads()[0].half_width_m;
  for (const double side : {-1.0, 1.0})
    for (double along_m = from_m + (side > 0 ? 3.5 : 0); along_m < to_m; along_m += b.random.uniform(6, 8.5F))
      b.place(b.drawPlant(tree, 5, 6.2F), 0, along_m, side * (curb_m + 0.8), 0, 0.4);
}

constexpr double kApproach_m = 48;
constexpr double kHedge_m = 2.2, kHouse_m = 7.2;  // from the curb to the middle

/// A cottage behind its hedge.
void placeCottage(SceneBuilder& b, int road, double along_m, double side, float length_m) {
  const double curb_m = side * b.scene.roads.roads()[road].half_width_m;
  b.place(makeCottage(length_m, 8, b.random.bits()), road, along_m, curb_m + side * kHouse_m, 0, 2.5);
  b.place(b.drawHedge(length_m - 0.5F, 0.7F, 1.1F), road, along_m, curb_m + side * kHedge_m, 0, 1.5);
}

/// Cottages in a row with a tree between any two.
void placeCottages(SceneBuilder& b, int road, double from_m, double to_m, double side) {
  constexpr double kPlot_m = 14;
  const double curb_m = b.scene.roads.roads()[road].half_width_m;
  for (double along_m = from_m; along_m < to_m; along_m += kPlot_m) {
    placeCottage(b, road, along_m, side, b.random.uniform(9, 11));
    b.place(b.drawPlant(makeTree, 4, 6), road, along_m + 0.5 * kPlot_m, side * (curb_m + 4.5), 0, 1.9);
    b.place(makeLampPost(b.random.bits()), road, along_m + 0.5 * kPlot_m, side * (curb_m + 0.6),
            side < 0 ? std::numbers::pi : 0, 0.3);
  }
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

void buildCorner(SceneBuilder& b) {
  b.scene.frames = 110;
  constexpr double kSideStreet_m = 24, kRadius_m = 7, kRight_m = 0.5 * kLane_m;
  const auto main_street = straight(-kApproach_m, 140);
  const auto side_street = makePath(kSideStreet_m, 0, -0.5 * std::numbers::pi, {{140, 0}});
  b.setRoads({street(main_street), street(side_street)});
  const double before_m = kApproach_m + kSideStreet_m - kRight_m - kRadius_m;
  const auto turn = makePath(-kApproach_m, -kRight_m, 0,
                             {{before_m, 0}, {0.5 * std::numbers::pi * kRadius_m, -0.5 * std::numbers::pi}, {80, 0}});
  const double v = vary(b.random, 4.8, 0.05);
  b.setEgo(drive(turn, kApproach_m - 10, Profile({{0, v}, {3, v}, {5, 3.6}, {8.5, 3.6}, {11, v}}), 0));
  // The corner itself has a cottage with hedges on both of its streets.
  placeCottage(b, 0, kApproach_m + 10, -1, 10);
  b.place(makeHedge(8, 0.9F, b.random.bits()), 1, 13, -(5.7 + kHedge_m), 0, 1.5);
  placeCottages(b, 0, kApproach_m - 32, kApproach_m, -1);
  placeCottages(b, 0, kApproach_m + 38, 180, -1);
  placeCottages(b, 0, kApproach_m - 30, 180, 1);
  for (const double side : {-1.0, 1.0}) placeCottages(b, 1, 26, 140, side);
}

void buildBrick(SceneBuilder& b) {
  b.scene.frames = 90;
  constexpr double kHalf_m = 4.2, kSidewalk_m = 1.8;
  constexpr float kRow_m = 24, kDepth_m = 8;
  const auto path = straight(-kApproach_m, 260);
  b.setRoads({{path, kHalf_m, {{0, 0.12, true}}}});
  const double v = vary(b.random, 8, 0.03);
  b.setEgo(drive(path, kApproach_m, v, -0.5 * kLane_m));
  if (b.scene.seed % 2 == 0)
    b.addMover(VehicleKind::kCar, drive(path, kApproach_m + 16, Profile({{0, v + 0.5}, {9, v - 0.3}}), -0.5 * kLane_m));
  else
    b.addMover(VehicleKind::kCar, drive(path, kApproach_m + 95, vary(b.random, 7, 0.05), 0.5 * kLane_m, true));
  const float tone = b.random.uniform(0.14F, 0.2F), height_m = 3.2F * 2 + 0.9F;
  for (const double side : {-1.0, 1.0}) {
    for (double along_m = 0.5 * kRow_m; along_m < kApproach_m + 260; along_m += kRow_m)
      b.place(makeTerrace(kRow_m, kDepth_m, height_m, tone), 0, along_m,
              side * (kHalf_m + kSidewalk_m + 0.5 * kDepth_m), 0, 1.2);
    for (double along_m = side < 0 ? 10 : 24; along_m < kApproach_m + 250; along_m += 28)
      b.place(makeLampPost(b.random.bits()), 0, along_m, side * (kHalf_m + 0.6), side < 0 ? std::numbers::pi : 0, 0.3);
  }
}

}  // namespace motorcade::synth
