#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "apps/synth/scenes/path.hpp"
#include "apps/synth/scenes/road_network.hpp"
#include "apps/synth/shapes/primitive.hpp"
#include "core/se3.hpp"

namespace motorcade::synth {

/// A thing that never moves; parked cars carry an object id.
struct Fixture {
  std::shared_ptr<const Model> model;
  SE3 T_map_body;
  int id = -1;
};

/// A vehicle in traffic, or a person on foot.
struct Mover {
  std::shared_ptr<const Model> model;
  Trajectory trajectory;
  int id = -1;
};

/// A world with its traffic, in the frame `map`: z up, road surface at z = 0.
struct Scene {
  std::string name;
  std::uint32_t seed = 0;
  int frames = 60;
  double frame_s = 0.1;
  int lap_frames = 0;             // the scene repeats after this many frames; 0: never
  bool meadow = false;            // grass beyond the curb instead of paving
  bool rain = false;              // no sun, and water on the road
  Vec3 sun{0.45F, 0.35F, 0.82F};  // unit vector towards the sun
  RoadNetwork roads;
  std::vector<Fixture> fixtures;
  std::vector<Mover> movers;
  Ego ego;

  /// Time of a frame; laps repeat exactly.
  double time_s(int frame) const { return frame_s * (lap_frames > 0 ? frame % lap_frames : frame); }
  int objectCount() const;
};

}  // namespace motorcade::synth
