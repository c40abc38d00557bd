#pragma once

#include <array>

#include "apps/synth/rendering/ray_tree.hpp"
#include "apps/synth/rendering/rays.hpp"
#include "apps/synth/scenes/ground.hpp"
#include "apps/synth/scenes/style.hpp"
#include "apps/synth/textures/texture.hpp"

namespace motorcade::synth {

/// Exposure of a point to the sun, and on the ground its cover by something low above it.
struct Exposure {
  bool sunny = false, covered = false;
  bool operator==(const Exposure&) const = default;
};

/// Light, depth and surface seen along a ray.
struct Sample {
  float light = 0;    // linear
  float depth_m = 0;  // 0: sky
  std::uint32_t surface = 0;
  std::int16_t object = -1;
  Exposure exposure;
};
/// True for the road and for the ground beside it behind the curb.
bool isLevelGround(std::uint32_t surface);

/// Casts rays of one camera of the stereo pair into one frame.
class RayCaster {
 public:
  RayCaster(const FrameScene& frame, const StereoCamera& camera, StereoSide side, Style style,
            const CalibrationErrors& errors);

  /// Casts a ray. `sharpness` over 1 narrows the texture filter, for rays that cover less than a pixel. A known
  /// exposure, from the pixel and its neighbors, saves the rays towards the light.
  Sample cast(float u_px, float v_px, float sharpness, const std::optional<Exposure>& known) const;

 private:
  struct Ray {
    Vec3 origin, direction;
    float pixel = 0;        // width of the pixel where t is 1
    float before_m = 0;     // way to the origin
    bool mirrored = false;  // has left a mirror already: meets no second one
    float width_m(float t) const { return (before_m + t) * pixel; }
  };
  struct Lit {
    float reflectance, light;
  };
  Sample sampleOf(const Ray& ray, const std::optional<RayHit>& hit, const std::optional<Exposure>& known) const;
  bool sunny(const Vec3& position, const Vec3& normal) const;
  Exposure exposureOf(const Ground::Hit& hit, const Vec3& position) const;
  float lit(const Vec3& normal, const Exposure& exposure) const;
  float shade(const RayHit& hit, const Vec3& normal, const Ray& ray, const Exposure& exposure) const;
  float wet(const Ground::Hit& hit, const Ray& ray, const Lit& dry) const;
  float surroundings(const RayHit& hit, const Vec3& normal, const Ray& ray) const;
  float smeared(const Ray& ray, float t, const Vec3& normal, float roughness) const;
  float mirrored(const Ray& ray, float t, const Vec3& normal) const;

  /// Reflectances in the style: every texture passes here.
  float dryGround(const Ground::Hit& hit, const Ray& ray) const;
  Reflectance styled(const SurfacePoint& point) const;

  const FrameScene& frame_;
  Style style_;
  Ground ground_;
  LensErrors lens_;
  CameraRays rays_;
  ParallelRays to_sun_, upwards_;
  std::optional<RayTree> tree_;  // where something mirrors
  float pixel_, sunlight_, skylight_;
};

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
