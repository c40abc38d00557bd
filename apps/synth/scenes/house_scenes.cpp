#include "apps/synth/scenes/house_scenes.hpp"

#include <numbers>

#include "apps/synth/models/house_model.hpp"
#include "apps/synth/models/street_model.hpp"
#include "apps/synth/scenes/scene_parts.hpp"

namespace motorcade::synth {
namespace {

constexpr double kApproach_m = 48;
constexpr double kHedge_m = 2.2, kHouse_m = 7.2;  // from the curb to the middle

/// A cottage behind its hedge.
void placeCottage(SceneBuilder& b, int road, double along_m, double side, float length_m) {
  const double curb_m = side * b.scene.roads.roads()[road].half_width_m;
  b.place(makeCottage(length_m, 8, b.random.bits()), road, along_m, curb_m + side * kHouse_m, 0, 2.5);
  b.place(makeHedge(length_m - 0.5F, b.random.uniform(0.7F, 1.1F), b.random.bits()), road, along_m,
          curb_m + side * kHedge_m, 0, 1.5);
}

/// Cottages in a row with a tree between any two.
void placeCottages(SceneBuilder& b, int road, double from_m, double to_m, double side) {
  constexpr double kPlot_m = 14;
  const double curb_m = b.scene.roads.roads()[road].half_width_m;
  for (double along_m = from_m; along_m < to_m; along_m += kPlot_m) {
    placeCottage(b, road, along_m, side, b.random.uniform(9, 11));
    b.place(makeTree(b.random.uniform(4, 6), b.random.bits()), road, along_m + 0.5 * kPlot_m, side * (curb_m + 4.5), 0,
            1.9);
    b.place(makeLampPost(b.random.bits()), road, along_m + 0.5 * kPlot_m, side * (curb_m + 0.6),
            side < 0 ? std::numbers::pi : 0, 0.3);
  }
}

}  // namespace

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
  constexpr double kHalf_m = 4.2, kPavement_m = 1.8;
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
              side * (kHalf_m + kPavement_m + 0.5 * kDepth_m), 0, 1.2);
    for (double along_m = side < 0 ? 10 : 24; along_m < kApproach_m + 250; along_m += 28)
      b.place(makeLampPost(b.random.bits()), 0, along_m, side * (kHalf_m + 0.6), side < 0 ? std::numbers::pi : 0, 0.3);
  }
}

}  // namespace motorcade::synth
