#pragma once

#include "apps/synth/shapes/noise.hpp"
#include "apps/synth/shapes/primitive.hpp"

/// Strokes that the textures of several kinds of vehicles share.
namespace motorcade::synth {

/// A thin line at `at`.
inline float line(float x, float at, float width, float footprint) {
  return inside(x, at - 0.5F * width, at + 0.5F * width, footprint);
}
/// Glyphs: a grid of cells that hold strokes chosen by a hash; 1 on ink.
float writing(float u, float v, float cell_width, float cell_height, float footprint, std::uint32_t seed);
/// Distance from the nearest wheel, in the side view; negative within it.
float wheelDistance(const Model& model, const Vec3& p);

}  // namespace motorcade::synth
