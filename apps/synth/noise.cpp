#include "apps/synth/noise.hpp"

namespace motorcade::synth {
namespace {

float fade(float t) { return t * t * (3 - 2 * t); }
float signedUnit(std::uint32_t hash) { return static_cast<float>(hash >> 8) * 0x1p-23F - 1; }

/// Integral of the pulse train from 0 to x.
float pulseIntegral(float x, float period, float width) {
  const float cycles = std::floor(x / period);
  return cycles * width + std::fmin(x - cycles * period, width);
}

}  // namespace

float pulses(float x, float period, float width, float footprint) {
  const float f = std::fmax(footprint, 1e-4F * period);
  return saturate((pulseIntegral(x + 0.5F * f, period, width) - pulseIntegral(x - 0.5F * f, period, width)) / f);
}

float noise2(float x, float y, std::uint32_t seed) {
  const float fx = std::floor(x), fy = std::floor(y);
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
  const float tx = fade(x - fx), ty = fade(y - fy);
  const float a = lerp(signedUnit(hashOf(ix, iy, seed)), signedUnit(hashOf(ix + 1, iy, seed)), tx);
  const float b = lerp(signedUnit(hashOf(ix, iy + 1, seed)), signedUnit(hashOf(ix + 1, iy + 1, seed)), tx);
  return lerp(a, b, ty);
}

float noise3(float x, float y, float z, std::uint32_t seed) {
  const float fz = std::floor(z);
  const int iz = static_cast<int>(fz);
  const float a = noise2(x, y, seed + static_cast<std::uint32_t>(iz) * 0x27d4eb2fU);
  const float b = noise2(x, y, seed + static_cast<std::uint32_t>(iz + 1) * 0x27d4eb2fU);
  return lerp(a, b, fade(z - fz));
}

float fractal2(float x, float y, float spacing, int octaves, float gain, float footprint, std::uint32_t seed) {
  float sum = 0, amplitude = 1;
  for (int i = 0; i < octaves; ++i, spacing *= 0.5F, amplitude *= gain) {
    const float weight = visible(spacing, footprint);
    if (weight <= 0) break;
    sum += weight * amplitude * noise2(x / spacing, y / spacing, seed + static_cast<std::uint32_t>(i));
  }
  return sum;
}

float fractal3(float x, float y, float z, float spacing, int octaves, float gain, float footprint, std::uint32_t seed) {
  float sum = 0, amplitude = 1;
  for (int i = 0; i < octaves; ++i, spacing *= 0.5F, amplitude *= gain) {
    const float weight = visible(spacing, footprint);
    if (weight <= 0) break;
    sum += weight * amplitude * noise3(x / spacing, y / spacing, z / spacing, seed + static_cast<std::uint32_t>(i));
  }
  return sum;
}

}  // namespace motorcade::synth
