#pragma once

#include "apps/synth/noise.hpp"
#include "apps/synth/primitive.hpp"

namespace motorcade::synth {

/// A person who walks: legs and arms swing with the distance covered. Size, clothes and bags follow the seed.
Model makePedestrian(std::uint32_t seed);

}  // namespace motorcade::synth
