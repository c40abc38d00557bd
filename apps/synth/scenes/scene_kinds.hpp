#pragma once

#include "apps/synth/scenes/scene_builder.hpp"

/// Scenes by their surroundings and road users. Further ones stand in scenes.cpp.
namespace motorcade::synth {

// Among fences, hedges and trees.

/// A winding street between picket fences and hedges, with one oncoming car.
void buildHedges(SceneBuilder& b);
/// A street under trees that sway in the wind, with parked cars below them and one car ahead.
void buildWindy(SceneBuilder& b);
/// Rows of parked cars on both sides under still trees. Nothing moves.
void buildParked(SceneBuilder& b);

// Among walls and roofs whose patterns repeat.

/// A turn around the corner of a low house: roof tiles, slatted shutters, hedges. Nothing moves.
void buildCorner(SceneBuilder& b);
/// A narrow street between brick walls, driven at constant speed, with one car: ahead for an even
/// seed, oncoming for an odd one.
void buildBrick(SceneBuilder& b);

// With hardly anything at rest in view.

/// Fifty vehicles on a road of nine lanes.
void buildCrowd(SceneBuilder& b);
/// A stop at a junction where trucks with trailers pass right ahead, from edge to edge of the view.
void buildTruck(SceneBuilder& b);
/// Buses ahead and on both sides: two thirds of the view move.
void buildWalledIn(SceneBuilder& b);

// With road users of all kinds.

/// An avenue with a side street: truck with trailer, bus, cyclists, cars with smooth and dark paint, people on foot.
void buildTraffic(SceneBuilder& b);
/// A street in the rain: the road mirrors; dark and smooth cars, a bus, a truck, a cyclist, people on the pavement.
void buildRain(SceneBuilder& b);
/// A crosswalk, approached slowly: people on foot and on bicycles from all sides.
void buildPeople(SceneBuilder& b);

/// A drive behind a car on a winding street, seen over the own bonnet: dark, curved, with a soft reflection of the
/// passing world.
void buildBonnet(SceneBuilder& b);

}  // namespace motorcade::synth
