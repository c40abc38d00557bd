#pragma once

#include "apps/synth/scenes/scene_builder.hpp"

/// Parts from which scenes are composed. Right-hand traffic; paths run along the map's x axis unless they bend.
namespace motorcade::synth {

using PathPtr = std::shared_ptr<const Path>;
constexpr double kLane_m = 3.5;

PathPtr makePath(double x, double y, double heading_rad, std::vector<Path::Piece> pieces, bool closed = false);
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
