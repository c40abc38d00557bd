#include <array>
#include <numbers>
#include <stdexcept>

#include "apps/synth/scenes/scene_builder.hpp"
#include "apps/synth/scenes/scene_kinds.hpp"

/// The scenes by name. Right-hand traffic; paths run along the map's x axis unless they bend.
namespace motorcade::synth {
namespace {

void buildStatic(SceneBuilder& b) {
  const auto path = makePath(-40, 0, 0, {{70, 0}, {60, 0.22}, {50, 0}, {60, -0.25}, {100, 0}});
  b.setRoads({street(path)});
  b.setEgo(drive(path, 40, vary(b.random, 8.5, 0.06), -1.75));
  b.dress(0, {.from_m = 20, .to_m = 320, .parked_share = 0.62});
}

void buildOvertake(SceneBuilder& b) {
  b.scene.frames = 28;
  const auto path = straight(-60, 240);
  b.setRoads({oneWay(path, 3, 2.3)});
  const double v = vary(b.random, 11, 0.04), start = 60;
  b.setEgo(drive(path, start, v, 0));
  b.addMover(VehicleKind::kCar, drive(path, start - 0.5 + b.random.uniform(-0.5F, 0.5F),
                                      Profile({{0, v + 5.5}, {2.8, v + 7.5}}), kLane_m));
  b.addMover(VehicleKind::kCar, drive(path, start - 4.5 + b.random.uniform(-0.5F, 0.5F),
                                      Profile({{0, v + 7.5}, {2.8, v + 8.5}}), -kLane_m));
  b.dress(0, {.from_m = 20, .to_m = 240, .parked_share = 0.35});
}

void buildHighway(SceneBuilder& b) {
  b.scene.frames = 212;
  b.scene.meadow = true;
  const auto path = makePath(-80, 0, 0, {{160, 0}, {160, 0.16}, {120, 0}, {170, -0.2}, {300, 0}});
  b.setRoads({oneWay(path, 3, 1.6)});
  const double v = vary(b.random, 19, 0.04), start = 80;
  b.setEgo(drive(path, start, Profile({{0, v}, {8, v + 1}, {16, v - 0.5}, {21, v}}), 0));
  struct Car {
    double ahead_m, lane, speed_change, late_change;
    VehicleKind kind;
  };
  const std::array<Car, 13> cars{{{17, 0, 0.5, 0.2, VehicleKind::kCar},
                                  {24, 1, 2.4, 2.8, VehicleKind::kCar},
                                  {20, -1, -0.7, -0.3, VehicleKind::kVan},
                                  {38, 0, 2.2, 2.6, VehicleKind::kCar},
                                  {42, -1, -1.1, -0.7, VehicleKind::kTruck},
                                  {8, 1, 2.0, 2.4, VehicleKind::kCar},
                                  {-14, 1, 2.6, 2.2, VehicleKind::kCar},
                                  {-30, 1, 2.8, 2.4, VehicleKind::kCar},
                                  {7, -1, -0.9, -0.5, VehicleKind::kCar},
                                  {-48, 1, 3.0, 2.8, VehicleKind::kCar},
                                  {58, 1, 3.2, 2.8, VehicleKind::kCar},
                                  {72, -1, -1.4, -1.0, VehicleKind::kTruck},
                                  {52, 0, 1.8, 2.2, VehicleKind::kCar}}};
  for (const auto& car : cars) {
    const double jitter = b.random.uniform(-1, 1);
    Profile left(car.lane * kLane_m);
    if (car.ahead_m == 38) left = Profile({{150, 0}, {230, kLane_m}});  // changes lane
    b.addMover(
        car.kind,
        drive(path, start + car.ahead_m + jitter,
              Profile({{0, v + car.speed_change}, {12, v + car.late_change}, {21, v + car.speed_change}}), left));
  }
  b.dress(0, {.from_m = 0, .to_m = 900, .clear_m = 5, .rural = true});
}

void buildUrban(SceneBuilder& b) {
  b.scene.frames = 100;
  const auto main_street = straight(-60, 260);
  const auto side_street = makePath(60, -120, 0.5 * std::numbers::pi, {{320, 0}});
  b.setRoads({street(main_street), street(side_street)});
  // Straight on, then left into the side street's right lane.
  constexpr double kRadius_m = 14;
  const double straight_m = 61.75 - kRadius_m + 60, arc_m = 0.5 * std::numbers::pi * kRadius_m;
  const auto turn = makePath(-60, -1.75, 0, {{straight_m, 0}, {arc_m, 0.5 * std::numbers::pi}, {200, 0}});
  const double v = vary(b.random, 9, 0.03);
  b.setEgo(drive(turn, 60, Profile({{0, v}, {2, v}, {5, 6.4}, {7.5, 6.4}, {10, v}}), 0));
  b.addMover(VehicleKind::kCar,
             drive(turn, 60 + 15, Profile({{0, v + 0.4}, {1.2, v + 0.4}, {4, 6.8}, {6.5, 6.8}, {9, v + 1}}), 0));
  b.addMover(VehicleKind::kCar, drive(main_street, 60 + 62, vary(b.random, 10, 0.05), 1.75, true));
  b.addMover(VehicleKind::kVan, drive(main_street, 60 + 82, vary(b.random, 10, 0.05), 1.75, true));
  // These two wait for the cars that turn.
  b.addMover(VehicleKind::kCar, drive(side_street, 120 + 64, Profile({{0, 8.5}, {3, 8.5}, {6.5, 0}}), 1.75, true));
  b.addMover(VehicleKind::kCar, drive(side_street, 120 + 97, Profile({{0, 9}, {5, 9}, {9, 0}}), 1.75, true));
  b.dress(0, {.from_m = 30, .to_m = 260, .parked_share = 0.45});
  b.dress(1, {.from_m = 40, .to_m = 300, .parked_share = 0.45});
}

void buildCrossing(SceneBuilder& b) {
  b.scene.frames = 70;
  const auto main_street = straight(-60, 220);
  const auto side_street = makePath(40, -110, 0.5 * std::numbers::pi, {{220, 0}});
  b.setRoads({street(main_street), street(side_street)});
  // Slows down towards the junction and lets the others pass.
  b.setEgo(drive(main_street, 60, Profile({{0, 6.5}, {1, 6.5}, {4.5, 2.0}, {7, 2.5}}), -1.75));
  const auto across = [&](VehicleKind kind, double before_m, double speed, bool from_left) {
    const double s = from_left ? 110 + before_m : 110 - before_m;
    b.addMover(kind, drive(side_street, s, vary(b.random, speed, 0.05), from_left ? 1.75 : -1.75, from_left));
  };
  across(VehicleKind::kCar, 9, 8.5, false);
  across(VehicleKind::kCar, 16, 9, true);
  across(VehicleKind::kVan, 33, 9, false);
  across(VehicleKind::kCar, 40, 8.5, true);
  across(VehicleKind::kCar, 52, 9.5, false);
  across(VehicleKind::kCar, 64, 9, true);
  b.dress(0, {.from_m = 30, .to_m = 220, .parked_share = 0.35});
  b.dress(1, {.from_m = 30, .to_m = 190, .parked_share = 0.1});
}

void buildLead(SceneBuilder& b) {
  b.scene.frames = 80;
  const auto path = makePath(-40, 0, 0, {{80, 0}, {70, 0.2}, {60, 0}, {70, -0.2}, {120, 0}});
  b.setRoads({street(path)});
  const double v = vary(b.random, 12, 0.04);
  b.setEgo(drive(path, 40, v, -1.75));
  Trajectory lead = drive(path, 40 + b.random.uniform(12, 14), v, -1.75);
  lead.sway_m = 0.4;
  lead.sway_period_s = 7;
  b.addMover(VehicleKind::kCar, lead);
  b.dress(0, {.from_m = 20, .to_m = 390, .parked_share = 0.4});
}

void buildStopAndGo(SceneBuilder& b) {
  b.scene.frames = 120;
  const auto path = straight(-50, 250);
  b.setRoads({street(path)});
  b.setEgo(drive(path, 50, Profile({{0, 8}, {1.2, 8}, {4.4, 0}, {6.8, 0}, {10, 8}}), -1.75));
  b.addMover(VehicleKind::kCar, drive(path, 50 + 13, Profile({{0, 8}, {0.6, 8}, {3.6, 0}, {5.8, 0}, {9, 8.5}}), -1.75));
  b.addMover(VehicleKind::kCar,
             drive(path, 50 + 22, Profile({{0, 8}, {0.3, 8}, {3.2, 0}, {5.2, 0}, {8.5, 8.5}}), -1.75));
  b.addMover(VehicleKind::kCar, drive(path, 50 + 75, vary(b.random, 9, 0.05), 1.75, true));
  b.addMover(VehicleKind::kVan, drive(path, 50 + 130, vary(b.random, 9, 0.05), 1.75, true));
  b.dress(0, {.from_m = 20, .to_m = 250, .parked_share = 0.4});
}

void buildConvoy(SceneBuilder& b) {
  const auto path = makePath(-60, 0, 0, {{110, 0}, {90, 0.12}, {200, 0}});
  b.setRoads({oneWay(path, 3, 1.5)});
  const double v = vary(b.random, 12, 0.03), start = 60;
  b.setEgo(drive(path, start, v, 0));
  const auto beside = [&](VehicleKind kind, double ahead_m, double lane, double change, double later) {
    b.addMover(kind, drive(path, start + ahead_m, Profile({{0, v + change}, {3, v + later}, {6, v + change}}),
                           lane * (kLane_m - 0.25)));
  };
  beside(VehicleKind::kTruck, 19.0, 0, 0.2, -0.3);
  beside(VehicleKind::kTruck, 9.5, 1, 0.6, -0.5);
  beside(VehicleKind::kVan, 9.0, -1, -0.4, 0.7);
  beside(VehicleKind::kVan, 21.0, 1, 0.3, -0.2);
  beside(VehicleKind::kTruck, 21.5, -1, -0.2, 0.4);
  beside(VehicleKind::kVan, 34.0, 0, 0.4, 0.2);
  b.dress(0, {.from_m = 20, .to_m = 330, .parked_share = 0});
}

void buildCircuit(SceneBuilder& b) {
  // A rounded rectangle, driven counterclockwise, starting in the middle of a straight.
  constexpr double kRadius_m = 20, kLong_m = 120, kShort_m = 60;
  const Path::Piece corner{0.5 * std::numbers::pi * kRadius_m, 0.5 * std::numbers::pi};
  const auto path = makePath(0, 0, 0,
                             {{0.5 * kLong_m, 0},
                              corner,
                              {kShort_m, 0},
                              corner,
                              {kLong_m, 0},
                              corner,
                              {kShort_m, 0},
                              corner,
                              {0.5 * kLong_m, 0}},
                             true);
  b.setRoads({street(path)});
  b.scene.lap_frames = 600;
  b.scene.frames = 600;
  const double lap_s = b.scene.frame_s * b.scene.lap_frames, v = path->length_m() / lap_s;
  b.scene.ego.shake_period_s = lap_s;
  const auto periodic = [&](double start_m, int laps, double left_m, double sway_m, int sways, bool backwards) {
    Trajectory t = drive(path, start_m, laps * v, left_m, backwards);
    t.sway_m = sway_m;
    t.sway_period_s = lap_s / sways;
    t.sway_phase_rad = b.random.uniform(0, 6);
    return t;
  };
  b.setEgo(periodic(0, 1, -1.75, 2.0, 2, false));
  b.addMover(VehicleKind::kCar, periodic(17, 1, -1.75, 2.5, 3, false));
  b.addMover(VehicleKind::kVan, periodic(38, 1, -1.75, 3.0, 2, false));
  for (int i = 0; i < 5; ++i)
    b.addMover(i == 2 ? VehicleKind::kVan : VehicleKind::kCar,
               periodic(50 + i * path->length_m() / 5 + b.random.uniform(-12, 12), 1, 1.75, 2.0, 2, true));
  b.dress(0, {.from_m = 0, .to_m = path->length_m() - 12, .parked_share = 0.4});
}

struct Entry {
  const char* name;
  void (*build)(SceneBuilder&);
};
constexpr std::array kScenes =
    std::to_array<Entry>({{"overtake", buildOvertake},     {"highway", buildHighway},   {"urban", buildUrban},
                          {"static", buildStatic},         {"crossing", buildCrossing}, {"lead", buildLead},
                          {"stop_and_go", buildStopAndGo}, {"convoy", buildConvoy},     {"circuit", buildCircuit},
                          {"traffic", buildTraffic},       {"rain", buildRain},         {"people", buildPeople},
                          {"crowd", buildCrowd},           {"truck", buildTruck},       {"walled_in", buildWalledIn},
                          {"corner", buildCorner},         {"brick", buildBrick},       {"hedges", buildHedges},
                          {"windy", buildWindy},           {"parked", buildParked},     {"bonnet", buildBonnet}});

}  // namespace

std::vector<std::string> sceneNames() {
  std::vector<std::string> names;
  for (const auto& entry : kScenes) names.emplace_back(entry.name);
  return names;
}

Scene makeScene(const std::string& name, std::uint32_t seed) {
  for (const auto& entry : kScenes)
    if (name == entry.name) {
      SceneBuilder builder(name, seed);
      entry.build(builder);
      return std::move(builder.scene);
    }
  throw std::invalid_argument("unknown scene '" + name + "'");
}

}  // namespace motorcade::synth
