#pragma once

#include <cstdint>

#include "apps/synth/shapes/vec3.hpp"

namespace motorcade::synth {

/// Light from infinity along a unit vector: sky with clouds, all cloud when overcast, and woods and hills on the
/// horizon.
float skyRadiance(const Vec3& direction, float pixel_rad, std::uint32_t seed, bool overcast);

}  // namespace motorcade::synth
