#pragma once

#include "apps/synth/shapes/noise.hpp"
#include "apps/synth/shapes/primitive.hpp"

namespace motorcade::synth {

/// A person who walks: legs and arms swing with the distance covered. Size, clothes and bags follow the seed.
Model makePedestrian(std::uint32_t seed);

}  // namespace motorcade::synth
