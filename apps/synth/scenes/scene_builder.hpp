#pragma once

#include <string>
#include <vector>

#include "apps/synth/models/models.hpp"
#include "apps/synth/scenes/scene.hpp"
#include "apps/synth/shapes/noise.hpp"

namespace motorcade::synth {

/// Appearance of the sides of a road.
struct Dressing {
  double from_m = 0, to_m = 0;  // stretch of the road
  double clear_m = 4;           // width of the pavement before the first wall or hedge
  bool buildings = true, trees = true;
  bool rural = false;       // hedges, bushes and guard rails instead of houses
  double parked_share = 0;  // of the parking spaces at the curb, 7 m each
  double smooth_share = 0;  // of the parked cars: smooth and dark paint
};

/// Puts a scene together. Ids are given in the order of the calls.
class SceneBuilder {
 public:
  SceneBuilder(std::string name, std::uint32_t seed);

  Scene scene;
  Random random;

  void setRoads(std::vector<Road> roads) { scene.roads = RoadNetwork(std::move(roads)); }
  void setEgo(Trajectory trajectory) { scene.ego.trajectory = std::move(trajectory); }
  using Plant = Model (*)(float size_m, std::uint32_t seed);
  /// A tree or a bush: the seed is drawn first, then the size.
  Model drawPlant(Plant make, float from_m, float to_m);
  /// The seed is drawn first, then the height.
  Model drawHedge(float length_m, float from_m, float to_m);
  void addMover(VehicleKind kind, Trajectory trajectory, Finish finish = Finish::kAny);
  void addMover(Model model, Trajectory trajectory);
  /// Two objects: the truck drives as given, its trailer follows on the same path.
  void addTruckWithTrailer(const Trajectory& trajectory);
  /// Adds a person who walks straight from one point of the map to another, up and down the curbs on the way.
  void addPedestrian(const Eigen::Vector2d& from, const Eigen::Vector2d& to, Profile speed_mps);
  void addParked(VehicleKind kind, int road, double along_m, double left_m, bool backwards,
                 Finish finish = Finish::kAny);
  /// Places a thing beside a road, unless it would stand nearer than the margin to any road. With a margin above 1 m
  /// its whole footprint counts, else its middle alone.
  void place(Model model, int road, double along_m, double left_m, double turn_rad, double margin_m);
  /// Adds houses, trees, poles, fences and parked cars along both sides of a road, clear of every other road and of
  /// crosswalks.
  void dress(int road, const Dressing& dressing);

 private:
  void placeWall(int road, const Dressing& dressing, double side);
  void placePavement(int road, const Dressing& dressing, double side);
  void parkCars(int road, const Dressing& dressing, double side);
  bool nearCrosswalk(int road, double along_m, double reach_m) const;
  int next_id_ = 0;
};

/// A speed that wanders by up to `share` of `mean` with the seed.
double vary(Random& random, double mean, double share);

std::vector<std::string> sceneNames();
/// Throws std::invalid_argument for an unknown name.
Scene makeScene(const std::string& name, std::uint32_t seed);

// Parts from which scenes are composed. Right-hand traffic; paths run along the map's x axis unless they bend.

using PathPtr = std::shared_ptr<const Path>;
constexpr double kLane_m = 3.5;

PathPtr makePath(double x, double y, double heading_rad, const std::vector<Path::Piece>& pieces, bool closed = false);
PathPtr straight(double from_m, double to_m);
/// Arc length on a path that starts `start_m` before the ego car's start.
Trajectory drive(const PathPtr& path, double start_m, Profile speed_mps, Profile left_m, bool backwards = false);

/// Two lanes and parking on both sides.
Road street(PathPtr path);
/// `lanes` lanes in one direction, with a parking strip on the right when it is wide enough.
Road oneWay(PathPtr path, int lanes, double shoulder_m);
/// Two lanes in each direction and parking on both sides.
Road avenue(PathPtr path);

}  // namespace motorcade::synth
