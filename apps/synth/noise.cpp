#include "apps/synth/noise.hpp"

namespace motorcade::synth {
namespace {

float fade(float t) { return t * t * (3 - 2 * t); }

/// Four lanes at once, by the compiler's vector types.
using Lanes = std::uint32_t __attribute__((vector_size(16)));
using LanesInt = std::int32_t __attribute__((vector_size(16)));
using LanesFloat = float __attribute__((vector_size(16)));

/// Random numbers in [-1, 1) at (ix, iy), (ix + 1, iy), (ix, iy + 1), (ix + 1, iy + 1): hashOf of each.
LanesFloat cornerValues(int ix, int iy, std::uint32_t seed) {
  const std::uint32_t x0 = static_cast<std::uint32_t>(ix) * 0x9e3779b1U,
                      y0 = static_cast<std::uint32_t>(iy) * 0x85ebca77U + seed * 0xc2b2ae3dU;
  const Lanes x{x0, x0 + 0x9e3779b1U, x0, x0 + 0x9e3779b1U}, y{y0, y0, y0 + 0x85ebca77U, y0 + 0x85ebca77U};
  Lanes h = x ^ y;
  h ^= h >> 16;
  h *= 0x7feb352dU;
  h ^= h >> 15;
  h *= 0x846ca68bU;
  h ^= h >> 16;
  return __builtin_convertvector(reinterpret_cast<LanesInt>(h >> 8), LanesFloat) * 0x1p-23F - 1.0F;
}

float blend(const LanesFloat& v, float tx, float ty) { return lerp(lerp(v[0], v[1], tx), lerp(v[2], v[3], tx), ty); }

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
  return blend(cornerValues(static_cast<int>(fx), static_cast<int>(fy), seed), fade(x - fx), fade(y - fy));
}

float noise3(float x, float y, float z, std::uint32_t seed) {
  const float fx = std::floor(x), fy = std::floor(y), fz = std::floor(z);
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
  const std::uint32_t below = seed + static_cast<std::uint32_t>(static_cast<int>(fz)) * 0x27d4eb2fU;
  const LanesFloat a = cornerValues(ix, iy, below), b = cornerValues(ix, iy, below + 0x27d4eb2fU);
  return blend(a + (b - a) * fade(z - fz), fade(x - fx), fade(y - fy));
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
