#include "apps/synth/scenes/scene_builder.hpp"

#include <numbers>

#include "apps/synth/scenes/ground.hpp"

namespace motorcade::synth {

int Scene::objectCount() const {
  int count = static_cast<int>(movers.size());
  for (const auto& fixture : fixtures) count += fixture.id >= 0 ? 1 : 0;
  return count;
}

double vary(Random& random, double mean, double share) { return mean * (1 + share * random.uniform(-1, 1)); }

SceneBuilder::SceneBuilder(std::string name, std::uint32_t seed) : random(mix(seed * 7919U + 13U)) {
  scene.name = std::move(name);
  scene.seed = seed;
  const float height = random.uniform(0.70F, 0.95F), aside = random.uniform(0.5F, 2.6F);
  const float azimuth = random.chance(0.5F) ? aside : -aside;
  scene.sun = {std::cos(height) * std::cos(azimuth), std::cos(height) * std::sin(azimuth), std::sin(height)};
}

Model SceneBuilder::drawPlant(Plant make, float from_m, float to_m) {
  const std::uint32_t seed = random.bits();
  return make(random.uniform(from_m, to_m), seed);
}

Model SceneBuilder::drawHedge(float length_m, float from_m, float to_m) {
  const std::uint32_t seed = random.bits();
  return makeHedge(length_m, random.uniform(from_m, to_m), seed);
}

void SceneBuilder::addMover(VehicleKind kind, Trajectory trajectory, Finish finish) {
  addMover(makeVehicle(kind, random.bits(), finish), std::move(trajectory));
}

void SceneBuilder::addMover(Model model, Trajectory trajectory) {
  scene.movers.push_back({std::make_shared<const Model>(std::move(model)), std::move(trajectory), next_id_++});
}

void SceneBuilder::addTruckWithTrailer(const Trajectory& trajectory) {
  constexpr float kGap_m = 0.25F;  // between the truck's rear and the drawbar's end
  Model truck = makeVehicle(VehicleKind::kTruck, random.bits()), trailer = makeTrailer(random.bits());
  const auto behind_m = static_cast<double>(0.5F * (truck.length_m + trailer.length_m) + kGap_m);
  Trajectory following = trajectory;
  following.start_m += trajectory.backwards ? behind_m : -behind_m;
  addMover(std::move(truck), trajectory);
  addMover(std::move(trailer), std::move(following));
}

void SceneBuilder::addPedestrian(const Eigen::Vector2d& from, const Eigen::Vector2d& to, Profile speed_mps) {
  // High enough for both feet while one of them is still on the pavement.
  constexpr double kFootRoom_m = 0.4, kStep_m = 1.2, kSearch_m = 0.05, kUp_m = static_cast<double>(Ground::kCurb_m);
  const Eigen::Vector2d way = to - from, along = way.normalized();
  const auto onRoad = [&](double at_m) {
    const Eigen::Vector2d p = from + at_m * along;
    return scene.roads.locate(p.x(), p.y()).outside_m < 0;
  };
  std::vector<Profile::Knot> height{{0, onRoad(0) ? 0 : kUp_m}};
  for (double at_m = kSearch_m; at_m < way.norm(); at_m += kSearch_m) {
    const bool before = onRoad(at_m - kSearch_m), after = onRoad(at_m);
    if (!before && after) height.insert(height.end(), {{at_m + kFootRoom_m, kUp_m}, {at_m + kFootRoom_m + kStep_m, 0}});
    if (before && !after) height.insert(height.end(), {{at_m - kFootRoom_m - kStep_m, 0}, {at_m - kFootRoom_m, kUp_m}});
  }
  Trajectory t;
  t.path = std::make_shared<const Path>(from, std::atan2(way.y(), way.x()), std::vector<Path::Piece>{{way.norm(), 0}});
  t.speed_mps = std::move(speed_mps);
  t.up_m = Profile(std::move(height));
  addMover(makePedestrian(random.bits()), std::move(t));
}

void SceneBuilder::addParked(VehicleKind kind, int road, double along_m, double left_m, bool backwards, Finish finish) {
  const auto point = scene.roads.roads()[road].path->at(along_m);
  const Eigen::Vector2d p = point.position + left_m * point.left();
  const double heading = point.heading_rad + (backwards ? std::numbers::pi : 0) + random.uniform(-0.02F, 0.02F);
  scene.fixtures.push_back({std::make_shared<const Model>(makeVehicle(kind, random.bits(), finish)),
                            SE3(expSO3({0, 0, heading}), {p.x(), p.y(), 0}), next_id_++});
}

void SceneBuilder::place(Model model, int road, double along_m, double left_m, double turn_rad, double margin_m) {
  if (margin_m < 1 && nearCrosswalk(road, along_m, 2.6)) return;  // what stands on the pavement
  const auto point = scene.roads.roads()[road].path->at(along_m);
  const Eigen::Vector2d p = point.position + left_m * point.left();
  Vec3 reach;
  for (const auto& part : model.parts) reach = max(reach, max(part.hi, part.lo * -1));
  // Large things: corners and middles of the footprint stay off all roads. Treetops and arms of lamps may overhang.
  const double heading = point.heading_rad + turn_rad, c = std::cos(heading), s = std::sin(heading);
  for (const double x : {-1.0, -0.5, 0.0, 0.5, 1.0})
    for (const double y : {-1.0, 0.0, 1.0}) {
      const double dx = margin_m > 1 ? x * reach.x : 0, dy = margin_m > 1 ? y * reach.y : 0;
      const auto where = scene.roads.locate(p.x() + c * dx - s * dy, p.y() + s * dx + c * dy);
      if (where.road >= 0 && where.outside_m < margin_m) return;
    }
  scene.fixtures.push_back(
      {std::make_shared<const Model>(std::move(model)), SE3(expSO3({0, 0, heading}), {p.x(), p.y(), 0})});
}

bool SceneBuilder::nearCrosswalk(int road, double along_m, double reach_m) const {
  const auto& crosswalks_m = scene.roads.roads()[road].crosswalks_m;
  return std::any_of(crosswalks_m.begin(), crosswalks_m.end(),
                     [&](double at_m) { return std::abs(at_m - along_m) < reach_m; });
}

void SceneBuilder::placeWall(int road, const Dressing& d, double side) {
  const double half = scene.roads.roads()[road].half_width_m;
  for (double s = d.from_m; s < d.to_m;) {
    const float length = random.uniform(9, 19);
    const double middle = s + 0.5 * length;
    const bool house = d.buildings && !random.chance(d.rural ? 0.85F : 0.18F);
    if (house) {
      const float depth = random.uniform(7, 11), height = random.uniform(5, 14);
      const double setback = random.uniform(0, 2.5F);
      place(makeBuilding(length - 0.4F, depth, height, random.bits()), road, middle,
            side * (half + d.clear_m + setback + 0.5 * depth + 0.9), 0, 2.5);
      if (setback > 1 && random.chance(0.6F))
        place(makeFence(length - 2, random.bits()), road, middle, side * (half + d.clear_m), 0, 1.5);
    } else if (random.chance(0.5F)) {
      place(drawHedge(length - 0.5F, 1.2F, 2.6F), road, middle, side * (half + d.clear_m + 0.6), 0, 1.5);
      for (const double back : {5.0, 9.0}) {
        const double along = middle + random.uniform(-4, 4);
        place(drawPlant(makeTree, 6, 10), road, along, side * (half + d.clear_m + back), 0, 1.9);
      }
    } else {
      place(makeFence(length - 1, random.bits()), road, middle, side * (half + d.clear_m + 0.3), 0, 1.5);
      place(makeBush(length - 3, random.bits()), road, middle, side * (half + d.clear_m + 2.2), 0, 1.5);
      place(drawPlant(makeTree, 5, 9), road, middle, side * (half + d.clear_m + 4.5), 0, 1.9);
    }
    s += length;
  }
}

void SceneBuilder::placePavement(int road, const Dressing& d, double side) {
  const double half = scene.roads.roads()[road].half_width_m;
  for (double s = d.from_m + random.uniform(0, 6); s < d.to_m; s += random.uniform(7, 13)) {
    if (d.trees && random.chance(0.6F)) {
      const double turn = random.uniform(0, 6);
      place(drawPlant(makeTree, 5.5F, 8.5F), road, s, side * (half + 1.1), turn, 0.4);
    }
    if (random.chance(0.35F))
      place(makeTrafficSign(random.bits()), road, s + 2.5, side * (half + 0.7), side < 0 ? 0.15 : 3.3, 0.3);
    if (!d.rural && random.chance(0.7F)) {
      const double turn = random.uniform(-0.2F, 0.2F);
      place(makeStreetClutter(random.bits()), road, s + 4, side * (half + d.clear_m - 0.9), turn, 0.5);
    }
  }
  for (double s = d.from_m + 11; s < d.to_m; s += 28)
    place(makeLampPost(random.bits()), road, s + (side > 0 ? 14 : 0), side * (half + 0.6),
          side < 0 ? std::numbers::pi : 0, 0.3);
  if (d.rural)
    for (double s = d.from_m; s < d.to_m; s += 12)
      place(makeGuardRail(12, random.bits()), road, s + 6, side * (half + 0.6), 0, 0.3);
}

void SceneBuilder::parkCars(int road, const Dressing& d, double side) {
  const double half = scene.roads.roads()[road].half_width_m;
  for (double s = d.from_m + 4; s < d.to_m; s += 7) {
    if (!random.chance(static_cast<float>(d.parked_share))) continue;
    const double left = side * (half - 1.05), along = s + random.uniform(-0.8F, 0.8F);
    const auto point = scene.roads.roads()[road].path->at(along);
    const Eigen::Vector2d p = point.position + left * point.left();
    const auto where = scene.roads.locate(p.x(), p.y());
    const bool in_junction = where.next_outside_m<7, in_tight_bend = std::abs(point.curvature_per_m)> 0.02;
    if (in_junction || in_tight_bend || nearCrosswalk(road, along, 5.5)) continue;
    const VehicleKind kind = random.chance(0.15F) ? VehicleKind::kVan : VehicleKind::kCar;
    Finish finish = Finish::kAny;
    if (d.smooth_share > 0 && random.chance(static_cast<float>(d.smooth_share)))
      finish = random.chance(0.5F) ? Finish::kSmoothDark : Finish::kSmoothLight;
    addParked(kind, road, along, left, side > 0, finish);
  }
}

void SceneBuilder::dress(int road, const Dressing& dressing) {
  for (const double side : {-1.0, 1.0}) {
    placeWall(road, dressing, side);
    placePavement(road, dressing, side);
    parkCars(road, dressing, side);
  }
}

PathPtr makePath(double x, double y, double heading_rad, const std::vector<Path::Piece>& pieces, bool closed) {
  return std::make_shared<const Path>(Eigen::Vector2d(x, y), heading_rad, pieces, closed);
}

PathPtr straight(double from_m, double to_m) { return makePath(from_m, 0, 0, {{to_m - from_m, 0}}); }

Trajectory drive(const PathPtr& path, double start_m, Profile speed_mps, Profile left_m, bool backwards) {
  Trajectory t;
  t.path = path;
  t.start_m = start_m;
  t.speed_mps = std::move(speed_mps);
  t.left_m = std::move(left_m);
  t.backwards = backwards;
  return t;
}

Road street(PathPtr path) { return {std::move(path), 5.7, {{0, 0.12, true}, {3.5, 0.12, false}, {-3.5, 0.12, false}}}; }

Road oneWay(PathPtr path, int lanes, double shoulder_m) {
  Road road{std::move(path), 0.5 * lanes * kLane_m + shoulder_m, {}};
  for (int i = 0; i <= lanes; ++i) road.lines.push_back({(i - 0.5 * lanes) * kLane_m, 0.14, i > 0 && i < lanes});
  return road;
}

Road avenue(PathPtr path) {
  constexpr double kParking_m = 2.2, kDouble_m = 0.14;
  Road road{std::move(path), 2 * kLane_m + kParking_m, {{-kDouble_m, 0.12, false}, {kDouble_m, 0.12, false}}};
  for (const double side : {-kLane_m, kLane_m}) {
    road.lines.push_back({side, 0.12, true});
    road.lines.push_back({2 * side, 0.12, false});
  }
  return road;
}

}  // namespace motorcade::synth
