#pragma once

#include "apps/synth/shapes/noise.hpp"
#include "apps/synth/shapes/primitive.hpp"

/// Houses whose surfaces repeat. Origins are on the ground; x runs along the street.
namespace motorcade::synth {

/// A low house under a hipped roof of tiles that reaches down to 2.7 m; windows between slatted shutters on all sides.
Model makeCottage(float length_m, float depth_m, std::uint32_t seed);
/// A row of brick houses: pillars, windows and ledges repeat every 4 m. Rows of a multiple of 4 m join without a seam.
Model makeTerrace(float length_m, float depth_m, float height_m, float tone);

}  // namespace motorcade::synth
