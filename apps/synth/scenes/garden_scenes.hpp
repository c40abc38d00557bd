#pragma once

#include "apps/synth/scenes/scene_builder.hpp"

/// Scenes among fences, hedges and trees.
namespace motorcade::synth {

/// A winding street between picket fences and hedges, with one oncoming car.
void buildHedges(SceneBuilder& b);
/// A street under trees that sway in the wind, with parked cars below them and one car ahead.
void buildWindy(SceneBuilder& b);
/// Rows of parked cars on both sides under still trees. Nothing moves.
void buildParked(SceneBuilder& b);

}  // namespace motorcade::synth
