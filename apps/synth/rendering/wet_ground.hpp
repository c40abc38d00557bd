#pragma once

#include <array>

#include "apps/synth/scenes/ground.hpp"

namespace motorcade::synth {

/// The water on a piece of ground.
struct WaterFilm {
  float darkening = 1;  // of the ground below: light that enters the water is not all let out again
  float mirror = 0;     // share of the surface that is water
  float roughness = 0;  // standard deviation of its slope
  Vec3 normal{};
};
/// Rain on road and pavement in one frame: a thin rough film, puddles in the hollows, rings of drops in them that
/// differ from frame to frame. `width_m` is that of a pixel across the ray.
WaterFilm waterFilm(const Ground::Hit& hit, float width_m, const Scene& scene, int frame);

/// Share of light that water mirrors, by the cosine of the angle of incidence (Schlick's approximation).
float waterReflectance(float cosine);

/// Slopes, in units of the roughness, with the variance of a normal distribution.
constexpr std::array<float, 3> kWaterSpread{-1.22F, 0, 1.22F};

}  // namespace motorcade::synth
