#pragma once

#include "apps/synth/shapes/noise.hpp"
#include "apps/synth/shapes/primitive.hpp"

/// Fences of gardens, and trees in wind. Origins are on the ground; x runs along the street.
namespace motorcade::synth {

/// Thin pickets on two rails; what is behind shows through the gaps.
Model makePicketFence(float length_m, std::uint32_t seed);
/// A tree with fine leaves whose crown sways, by 3 cm at its lower branches and 15 cm at its top.
Model makeSwayingTree(float height_m, std::uint32_t seed);

}  // namespace motorcade::synth
