#include <numbers>
#include <utility>

#include "apps/synth/models/models.hpp"
#include "apps/synth/scenes/scene_builder.hpp"
#include "apps/synth/scenes/scene_kinds.hpp"

namespace motorcade::synth {
namespace {

constexpr double kStart_m = 60;  // road behind the ego car

/// Arc length at the ego car's start: so much road lies behind it.
constexpr double kRoadBehind_m = 60;
constexpr double kPavement_m = 1.95;  // from the curb to where people walk, between trees and walls

double jitter(SceneBuilder& b, float reach) { return b.random.uniform(-reach, reach); }

/// Adds a person who walks along the straight first road, `left_m` from its middle; negative speeds lead backwards.
void addWalker(SceneBuilder& b, double x_m, double left_m, double speed_mps) {
  constexpr double kWay_m = 40;
  const double x = x_m + jitter(b, 1), ahead = speed_mps > 0 ? 1 : -1;
  b.addPedestrian({x, left_m}, {x + ahead * kWay_m, left_m}, std::abs(vary(b.random, speed_mps, 0.04)));
}

/// Both arms of a side street, from beyond the first road's pavements on.
void dressSideStreet(SceneBuilder& b, double middle_m, double reach_m, const Dressing& dressing) {
  constexpr double kClear_m = 8;
  const double from_m = b.scene.roads.roads()[0].half_width_m + kClear_m;
  for (const double side : {-1.0, 1.0}) {
    Dressing arm = dressing;
    arm.from_m = middle_m + (side < 0 ? -reach_m : from_m);
    arm.to_m = middle_m + (side < 0 ? -from_m : reach_m);
    b.dress(1, arm);
  }
}

void addCyclist(SceneBuilder& b, Trajectory trajectory) {
  b.addMover(makeCyclist(b.random.bits()), std::move(trajectory));
}

void addBus(SceneBuilder& b, Trajectory trajectory) { b.addMover(makeBus(b.random.bits()), std::move(trajectory)); }

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

void buildTraffic(SceneBuilder& b) {
  b.scene.frames = 110;
  const auto path = makePath(-kRoadBehind_m, 0, 0, {{160, 0}, {90, 0.2}, {120, 0}});
  const auto side_street = makePath(68, -120, 0.5 * std::numbers::pi, {{240, 0}});
  b.setRoads({avenue(path), street(side_street)});
  const double v = vary(b.random, 8.5, 0.03);
  b.setEgo(drive(path, kRoadBehind_m, v, -0.5 * kLane_m));
  const auto ahead = [&](double m) { return kRoadBehind_m + m + jitter(b, 0.5F); };
  const auto varied = [&](double m, double speed_mps, double share, double left_m, bool backwards) {
    const double drawn_mps = vary(b.random, speed_mps, share);
    return drive(path, ahead(m), drawn_mps, left_m, backwards);
  };
  constexpr double kInner_m = 0.5 * kLane_m, kOuter_m = 1.5 * kLane_m, kEdge_m = 6.5;
  b.addTruckWithTrailer(drive(path, ahead(17), Profile({{0, 6.2}, {6, 5.8}, {11, 6.2}}), -kOuter_m));
  b.addMover(VehicleKind::kCar, drive(path, ahead(15), Profile({{0, v + 0.6}, {6, v - 0.2}, {11, v + 0.6}}), -kInner_m),
             Finish::kSmoothDark);
  b.addMover(VehicleKind::kCar, drive(path, ahead(25), v + 0.3, -kInner_m), Finish::kSmoothLight);
  addCyclist(b, varied(43, 5.5, 0.02, -kEdge_m, false));
  addBus(b, varied(47, 8, 0.03, kInner_m, true));
  b.addMover(VehicleKind::kCar, varied(74, 8, 0.03, kInner_m, true), Finish::kDark);
  b.addMover(VehicleKind::kCar, varied(104, 8, 0.03, kInner_m, true), Finish::kSmoothLight);
  b.addTruckWithTrailer(varied(132, 8, 0.03, kInner_m, true));
  b.addMover(VehicleKind::kCar, varied(22, 8, 0.03, kOuter_m, true), Finish::kSmoothDark);
  addCyclist(b, varied(36, 5.5, 0.03, kEdge_m, true));
  b.addMover(VehicleKind::kVan, varied(75, 7, 0.03, kOuter_m, true), Finish::kSmoothDark);
  // Comes from the side street and waits.
  b.addMover(VehicleKind::kCar, drive(side_street, 120 - 42, Profile({{0, 7}, {1, 7}, {6.5, 0}}), -kInner_m),
             Finish::kSmoothLight);
  const double pavement_m = b.scene.roads.roads()[0].half_width_m + kPavement_m;
  addWalker(b, 26, -pavement_m, 1.4);
  addWalker(b, 42, -pavement_m, 1.5);
  addWalker(b, 58, -pavement_m, 1.6);
  addWalker(b, 34, pavement_m, -1.3);
  addWalker(b, 52, pavement_m, -1.5);
  addWalker(b, 86, pavement_m, -1.4);
  b.dress(0, {.from_m = 30, .to_m = 360, .parked_share = 0.45, .smooth_share = 0.4});
  dressSideStreet(b, 120, 90, {.parked_share = 0.3, .smooth_share = 0.4});
}

void buildRain(SceneBuilder& b) {
  b.scene.frames = 100;
  b.scene.rain = true;
  const auto path = makePath(-kRoadBehind_m, 0, 0, {{150, 0}, {70, 0.2}, {160, 0}});
  b.setRoads({street(path)});
  const double v = vary(b.random, 8, 0.03);
  constexpr double kLeft_m = -1.5, kOncoming_m = 1.75;
  b.setEgo(drive(path, kRoadBehind_m, v, kLeft_m));
  const auto ahead = [&](double m) { return kRoadBehind_m + m + jitter(b, 0.5F); };
  b.addMover(VehicleKind::kCar, drive(path, ahead(14), Profile({{0, v + 0.6}, {5, v - 0.3}, {10, v + 0.5}}), kLeft_m),
             Finish::kDark);
  addBus(b, drive(path, ahead(28), v + 0.2, kLeft_m));
  const double cyclist_mps = vary(b.random, 5, 0.03);
  addCyclist(b, drive(path, ahead(17), cyclist_mps, -3.05));
  const auto oncoming = [&](double m) {
    const double drawn_mps = vary(b.random, 8.5, 0.02);
    return drive(path, ahead(m), drawn_mps, kOncoming_m, true);
  };
  b.addMover(VehicleKind::kCar, oncoming(30), Finish::kSmoothDark);
  b.addMover(VehicleKind::kCar, oncoming(46), Finish::kSmoothLight);
  b.addMover(VehicleKind::kVan, oncoming(68), Finish::kSmoothDark);
  b.addMover(VehicleKind::kTruck, oncoming(92));
  b.addMover(VehicleKind::kCar, oncoming(116), Finish::kDark);
  addBus(b, oncoming(142));
  const double pavement_m = b.scene.roads.roads()[0].half_width_m + kPavement_m;
  addWalker(b, 24, -pavement_m, 1.5);
  addWalker(b, 40, -pavement_m, 1.8);
  addWalker(b, 56, -pavement_m, 1.6);
  addWalker(b, 30, pavement_m, -1.6);
  addWalker(b, 48, pavement_m, -1.8);
  addWalker(b, 66, pavement_m, -1.5);
  b.dress(0, {.from_m = 30, .to_m = 370, .parked_share = 0.4, .smooth_share = 0.6});
}

void buildPeople(SceneBuilder& b) {
  b.scene.frames = 120;
  constexpr double kCrosswalk_m = 28, kSideStreet_m = 48, kEdge_m = 2.9;
  const auto path = straight(-kRoadBehind_m, 200);
  const auto side_street = makePath(kSideStreet_m, -100, 0.5 * std::numbers::pi, {{200, 0}});
  Road main_street = street(path);
  main_street.crosswalks_m = {kRoadBehind_m + kCrosswalk_m};
  b.setRoads({main_street, street(side_street)});
  b.setEgo(
      drive(path, kRoadBehind_m, Profile({{0, 4.5}, {1.5, 4.5}, {5, 1.0}, {8.5, 1.0}, {12, 4.5}}), -0.5 * kLane_m));
  // People who cross walk in lanes of their own.
  const auto cross = [&](double x_m, double from_m, double start_s, double speed_mps) {
    const double speed = vary(b.random, speed_mps, 0.03);
    b.addPedestrian({kCrosswalk_m + x_m, from_m}, {kCrosswalk_m + x_m, -from_m},
                    Profile({{start_s, 0.0}, {start_s + 0.8, speed}}));
  };
  cross(0.9, -7.8, 0, 1.4);
  cross(-1.0, 8.5, 0.6, 1.5);
  cross(0, -7.3, 2.2, 1.35);
  cross(-1.9, 8.0, 3.2, 1.9);
  const double pavement_m = main_street.half_width_m + kPavement_m;
  addWalker(b, 9, -pavement_m, 1.3);
  addWalker(b, 15, -pavement_m, 1.45);
  addWalker(b, 22, pavement_m, -1.4);
  addWalker(b, 33, pavement_m, 1.35);
  addCyclist(b, drive(path, kRoadBehind_m + 16, vary(b.random, 5, 0.03), -kEdge_m));
  addCyclist(b, drive(path, kRoadBehind_m + 44, vary(b.random, 5.2, 0.03), kEdge_m, true));
  addCyclist(b, drive(side_street, 100 - 43, vary(b.random, 4.5, 0.03), -kEdge_m));
  // Waits for those who cross.
  b.addMover(VehicleKind::kCar,
             drive(path, kRoadBehind_m + 60, Profile({{0, 6}, {1.5, 6}, {6, 0}}), 0.5 * kLane_m, true),
             Finish::kSmoothDark);
  b.dress(0, {.from_m = 30, .to_m = 250, .parked_share = 0.45, .smooth_share = 0.3});
  dressSideStreet(b, 100, 70, {.parked_share = 0.3, .smooth_share = 0.3});
}

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
