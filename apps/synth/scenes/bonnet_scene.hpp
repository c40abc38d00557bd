#pragma once

#include "apps/synth/scenes/scene_builder.hpp"

namespace motorcade::synth {

/// A drive behind a car on a winding street, seen over the own bonnet: dark, curved, with a soft reflection of the
/// passing world.
void buildBonnet(SceneBuilder& b);

}  // namespace motorcade::synth
