#include "apps/synth/rendering/wet_ground.hpp"

#include "apps/synth/shapes/noise.hpp"

namespace motorcade::synth {

WaterFilm waterFilm(const Ground::Hit& hit, float width_m, const Scene& scene, int frame) {
  constexpr float kPavingEnd_m = 3.6F;  // as in Ground
  WaterFilm film{.normal = hit.normal};
  if (hit.curb_face || hit.where.outside_m > kPavingEnd_m || (scene.meadow && hit.where.outside_m > 0)) {
    film.darkening = 0.75F;  // wet stone or grass, no closed film
    return film;
  }
  const float x = hit.position_map.x, y = hit.position_map.y;
  const bool road = hit.where.outside_m < 0;
  const std::uint32_t seed = scene.seed * 131U;
  // Water gathers in hollows, and along the curb.
  const float gutter = road ? 0.5F * saturate(1 + hit.where.outside_m / 0.9F) : 0;
  const float hollow = fractal2(x, y, {3.1F, 4, 0.55F}, width_m, seed) + gutter;
  const float puddle = saturate((hollow - 0.25F) / 0.2F);
  film.darkening = road ? lerp(0.42F, 0.30F, puddle) : lerp(0.6F, 0.5F, puddle);
  film.mirror = lerp(road ? 0.75F : 0.5F, 1, puddle);
  film.roughness = lerp(road ? 0.035F : 0.05F, 0.003F, puddle);
  const float film_slope = 0.02F * (1 - puddle), ring_slope = 0.012F * puddle;
  const auto slope = [&](std::uint32_t salt) {
    return film_slope * fractal2(x, y, {0.6F, 4, 0.8F}, width_m, seed + 10 + salt) +
           ring_slope * fractal2(x, y, {0.12F, 2, 0.8F}, width_m, hashOf(frame, static_cast<int>(salt), seed));
  };
  film.normal = normalized({slope(1), slope(2), 1});
  return film;
}

float waterReflectance(float cosine) {
  constexpr float kHeadOn = 0.02F;  // refractive index 1.33
  const float rest = saturate(1 - cosine);
  return kHeadOn + (1 - kHeadOn) * rest * rest * rest * rest * rest;
}

}  // namespace motorcade::synth
