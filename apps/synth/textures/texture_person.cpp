#include "apps/synth/shapes/noise.hpp"
#include "apps/synth/textures/texture.hpp"

namespace motorcade::synth {
namespace {

/// Folds at all sizes; some cloth of an even seed has stripes or checks.
float cloth(const SurfacePoint& s) {
  const Vec3& p = s.position;
  const float f = s.footprint_m;
  float tone = s.part->tone;
  const std::uint32_t pattern = (s.part->seed & 1U) != 0 ? 5 : mix(s.part->seed) % 6;
  const float contrast = tone > 0.2F ? -0.6F : 1.6F;
  if (pattern == 0) tone *= 1 + contrast * pulses(p.z, 0.11F, 0.05F, f);
  if (pattern == 1) tone *= 1 + 0.5F * contrast * (pulses(p.z, 0.09F, 0.035F, f) + pulses(p.y, 0.09F, 0.035F, f));
  const float folds = fractal3(p.x, p.y, 0.6F * p.z, {0.13F, 5, 0.75F}, f, s.part->seed + 1);
  return std::fmax(0.015F, tone * (1 + 0.45F * folds));
}

}  // namespace

Reflectance personReflectance(const SurfacePoint& s) {
  if (s.part->material == Material::kCloth) return {cloth(s), 0, 0};
  const Vec3& p = s.position;
  return {s.part->tone * (1 + 0.2F * fractal3(p.x, p.y, p.z, {0.06F, 3, 0.7F}, s.footprint_m, s.part->seed)), 0.02F, 0};
}

}  // namespace motorcade::synth
