#include "apps/synth/scenes/crowded_scenes.hpp"

#include <numbers>
#include <utility>

#include "apps/synth/models/large_vehicle_model.hpp"
#include "apps/synth/scenes/scene_parts.hpp"

namespace motorcade::synth {
namespace {

constexpr double kStart_m = 60;  // road behind the ego car

}  // namespace

void buildCrowd(SceneBuilder& b) {
  b.scene.frames = 60;
  constexpr int kLanes = 9, kVehicles = 50, kSide = kLanes / 2;
  const auto path = straight(-kStart_m, 300);
  b.setRoads({oneWay(path, kLanes, 1.5)});
  const double v = vary(b.random, 9, 0.03);
  b.setEgo(drive(path, kStart_m, v, 0));
  // Rows of vehicles, each lane a little faster than the one on its right, its rows as far apart.
  for (int i = 0; i < kVehicles; ++i) {
    const int lane = i % kLanes - kSide, row = i / kLanes;
    constexpr double kRow_m = 14, kStagger_m = 2.5;
    const double ahead_m = (lane == 0 ? 16 : 8) + kRow_m * row + kStagger_m * (i % 3) + b.random.uniform(-0.5F, 0.5F);
    const double faster = 0.6 * lane + (lane == 0 ? 0.4 : 0);
    b.addMover(row % 3 == 2 ? VehicleKind::kVan : VehicleKind::kCar,
               drive(path, kStart_m + ahead_m, Profile({{0, v + faster}, {3, v + 0.7 * faster}, {6, v + faster}}),
                     lane * kLane_m));
  }
  b.dress(0, {.from_m = 20, .to_m = 330, .parked_share = 0});
}

void buildTruck(SceneBuilder& b) {
  b.scene.frames = 110;
  constexpr double kJunction_m = 26;
  const auto path = straight(-kStart_m, 200);
  const auto side_street = makePath(kJunction_m, -120, 0.5 * std::numbers::pi, {{240, 0}});
  b.setRoads({street(path), street(side_street)});
  b.setEgo(drive(path, kStart_m, Profile({{0, 7}, {1, 7}, {4.6, 0}, {8.6, 0}, {11, 6}}), -0.5 * kLane_m));
  const auto across = [&](double before_m, double left_m, bool backwards) {
    const double along_m = backwards ? 120 + before_m : 120 - before_m;
    b.addTruckWithTrailer(drive(side_street, along_m, vary(b.random, 6.5, 0.04), left_m, backwards));
  };
  across(24, -0.5 * kLane_m, false);
  across(34, 0.5 * kLane_m, true);
  across(46, -0.5 * kLane_m, false);
  b.dress(0, {.from_m = 30, .to_m = 240, .parked_share = 0.35});
  b.dress(1, {.from_m = 30, .to_m = 210, .parked_share = 0.1});
}

void buildWalledIn(SceneBuilder& b) {
  b.scene.frames = 80;
  const auto path = makePath(-kStart_m, 0, 0, {{100, 0}, {80, 0.12}, {150, 0}});
  b.setRoads({oneWay(path, 3, 1.5)});
  const double v = vary(b.random, 10, 0.03);
  b.setEgo(drive(path, kStart_m, v, 0));
  const auto beside = [&](Model model, double ahead_m, double left_m, double change, double later) {
    b.addMover(std::move(model), drive(path, kStart_m + ahead_m + b.random.uniform(-0.3F, 0.3F),
                                       Profile({{0, v + change}, {4, v + later}, {8, v + change}}), left_m));
  };
  beside(makeBus(b.random.bits()), 12.5, 0.2, 0.3, -0.6);
  beside(makeBus(b.random.bits()), 11.5, 3.3, 0.7, -0.4);
  beside(makeBus(b.random.bits()), 12.5, -3.3, -0.5, 0.8);
  beside(makeBus(b.random.bits()), 25, 3.3, 0.7, -0.4);
  b.dress(0, {.from_m = 20, .to_m = 320, .parked_share = 0});
}

}  // namespace motorcade::synth
