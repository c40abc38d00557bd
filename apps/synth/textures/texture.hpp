#pragma once

#include <cstdint>

#include "apps/synth/shapes/primitive.hpp"
#include "core/elementary.hpp"

namespace motorcade::synth {

/// A surface point of a part that a ray meets, in its model's frame.
struct SurfacePoint {
  const Primitive* part = nullptr;
  const Model* model = nullptr;
  Vec3 position, normal;
  float footprint_m = 0;      // width of a pixel on the surface
  float wheel_angle_rad = 0;  // how far the vehicle's wheels have turned
};

/// Angle of (x, y) from the x axis. The C library's for floats changes with its version: that of glibc 2.41 has other
/// last bits than that of 2.36.
inline float angleOf(float y, float x) {
  return static_cast<float>(arcTangent(static_cast<double>(y), static_cast<double>(x)));
}

/// Response of a surface to light.
struct Reflectance {
  float diffuse = 0.5F;
  float mirror = 0;  // share of the sky seen as in a mirror
  float glow = 0;    // light of its own
};

Reflectance vehicleReflectance(const SurfacePoint& point);
/// The body of a bus.
Reflectance coachReflectance(const SurfacePoint& point);
Reflectance personReflectance(const SurfacePoint& point);
/// Masonry, tiles and slats that repeat, and window panes.
Reflectance houseReflectance(const SurfacePoint& point);
Reflectance streetReflectance(const SurfacePoint& point);
/// Chooses by material.
Reflectance reflectanceOf(const SurfacePoint& point);

/// Light from infinity along a unit vector: sky with clouds, all cloud when overcast, and woods and hills on the
/// horizon.
float skyRadiance(const Vec3& direction, float pixel_rad, std::uint32_t seed, bool overcast);

}  // namespace motorcade::synth
