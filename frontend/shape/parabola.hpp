#pragma once

namespace motorcade {

/// Place of the least value of a parabola through three neighboring values, in -1/2 ... 1/2.
inline float parabolaOffset(int before, int least, int after) {
  const int curvature = before + after - 2 * least;
  return curvature > 0 ? 0.5F * static_cast<float>(before - after) / static_cast<float>(curvature) : 0.0F;
}

}  // namespace motorcade
