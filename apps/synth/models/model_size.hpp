#pragma once

#include "apps/synth/shapes/primitive.hpp"

namespace motorcade::synth {

/// Gives the model the smallest box about its origin that holds all parts; where limbs move, at every point of a cycle
/// that takes `cycle_m` of way.
void fitBox(Model& model, double cycle_m = 0);

}  // namespace motorcade::synth
