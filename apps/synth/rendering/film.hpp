#pragma once

#include <cstdint>
#include <vector>

#include "apps/synth/shapes/vec3.hpp"

/// The style `film`: its textures, and the effects of its lens and its film on images.
namespace motorcade::synth {

/// Reflectance of a surface whose grain is veins instead of lumps, with less contrast at large. `strength` is that of
/// the veins.
float veined(float reflectance, const Vec3& position_m, float footprint_m, std::uint32_t seed, float strength);

/// One image on its way to the sensor, in gray levels.
struct FilmShot {
  int width, height;
  bool right;  // camera of the pair
  double time_s;
  double period_s;  // after which the drive repeats, or 0
  std::uint32_t scene_seed, grain_seed;
};
/// Blurs the image as a lens does, darkens its corners, exposes it for the moment and adds the film's grain.
void develop(std::vector<float>& levels, const FilmShot& shot);

/// Gain of one camera's exposure: wanders by up to 15 % within seconds, and between the cameras by up to 4 %.
float exposureGain(const FilmShot& shot);

}  // namespace motorcade::synth
