#pragma once

#include "apps/synth/shapes/primitive.hpp"

namespace motorcade::synth {

/// Gives the model the smallest box about its origin that holds all parts. If limbs move, it holds them at every point
/// of a cycle of `cycle_m`.
void fitBox(Model& model, double cycle_m = 0);

}  // namespace motorcade::synth
