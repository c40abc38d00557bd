#pragma once

#include "apps/synth/shapes/primitive.hpp"

namespace motorcade::synth {

/// A bicycle with its rider: wheels and cranks turn, legs follow the pedals.
Model makeCyclist(std::uint32_t seed);

}  // namespace motorcade::synth
