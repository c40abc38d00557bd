#pragma once

#include <initializer_list>

#include "apps/synth/shapes/noise.hpp"
#include "apps/synth/shapes/primitive.hpp"

/// Parts that vehicles of all kinds have.
namespace motorcade::synth {

/// Measures and colors shared by a vehicle's parts.
struct Shape3 {
  float length, width, height;
  float paint;
  std::uint32_t seed;
  float front() const { return 0.5F * length; }
  float side() const { return 0.5F * width; }
};

/// A pair of wheels on each axle.
void addWheels(Model& model, const Shape3& s, float radius, std::initializer_list<float> axles);
/// A part and its mirror image across the vehicle's middle plane.
void addPair(Model& model, Material material, const Vec3& lo, const Vec3& hi, float tone, std::uint32_t seed);
/// Bumper, lamps, grille and plate.
void addFront(Model& model, const Shape3& s, float lamp_z);
void addRear(Model& model, const Shape3& s, float lamp_z, float lamp_height);

}  // namespace motorcade::synth
