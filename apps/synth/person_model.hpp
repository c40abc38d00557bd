#pragma once

#include "apps/synth/noise.hpp"
#include "apps/synth/primitive.hpp"

namespace motorcade::synth {

/// Someone who walks: legs and arms swing with the way covered. Size, clothes and bags follow the seed.
Model makePedestrian(std::uint32_t seed);

}  // namespace motorcade::synth
