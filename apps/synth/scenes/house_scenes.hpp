#pragma once

#include "apps/synth/scenes/scene_builder.hpp"

/// Scenes among walls and roofs whose patterns repeat.
namespace motorcade::synth {

/// A turn around the corner of a low house: roof tiles, slatted shutters, hedges. Nothing moves.
void buildCorner(SceneBuilder& b);
/// A narrow street between brick walls, driven at constant speed, with one car: ahead for an even
/// seed, oncoming for an odd one.
void buildBrick(SceneBuilder& b);

}  // namespace motorcade::synth
