#pragma once

#include "apps/synth/scenes/scene_builder.hpp"

/// Scenes with hardly anything at rest in view.
namespace motorcade::synth {

/// Fifty vehicles on a road of nine lanes.
void buildCrowd(SceneBuilder& b);
/// A stop at a junction where trucks with trailers pass right ahead, from edge to edge of the view.
void buildTruck(SceneBuilder& b);
/// Buses ahead and on both sides: two thirds of the view move.
void buildWalledIn(SceneBuilder& b);

}  // namespace motorcade::synth
