#pragma once

#include "apps/synth/shapes/primitive.hpp"

namespace motorcade::synth {

/// A city bus of two axles, 12 m long.
Model makeBus(std::uint32_t seed);
/// A box on two axles close together, with a drawbar; follows a truck.
Model makeTrailer(std::uint32_t seed);

}  // namespace motorcade::synth
