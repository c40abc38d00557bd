#pragma once

#include "apps/synth/scenes/scene_builder.hpp"

/// Scenes with road users of all kinds.
namespace motorcade::synth {

/// An avenue with a side street: truck with trailer, bus, cyclists, cars with smooth and dark paint, people on foot.
void buildTraffic(SceneBuilder& b);
/// A street in the rain: the road mirrors; dark and smooth cars, a bus, a truck, a cyclist, people on the pavement.
void buildRain(SceneBuilder& b);
/// A crosswalk, approached slowly: people on foot and on bicycles from all sides.
void buildPeople(SceneBuilder& b);

}  // namespace motorcade::synth
