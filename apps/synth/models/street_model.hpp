#pragma once

#include "apps/synth/shapes/noise.hpp"
#include "apps/synth/shapes/primitive.hpp"

/// Objects along a street. Origins are on the ground; x runs along the street.
namespace motorcade::synth {

Model makeBuilding(float length_m, float depth_m, float height_m, std::uint32_t seed);
Model makeTree(float height_m, std::uint32_t seed);
Model makeBush(float length_m, std::uint32_t seed);
Model makeHedge(float length_m, float height_m, std::uint32_t seed);
/// Posts with rails, or boards.
Model makeFence(float length_m, std::uint32_t seed);
Model makeLampPost(std::uint32_t seed);
Model makeTrafficSign(std::uint32_t seed);
Model makeGuardRail(float length_m, std::uint32_t seed);
/// Bins, boxes and posts: small things on the pavement.
Model makeStreetClutter(std::uint32_t seed);

}  // namespace motorcade::synth
