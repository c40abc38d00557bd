#pragma once

#include <cmath>
#include <cstdint>

/// Band-limited procedural signals. Each takes the footprint of the pixel on the surface [m] and leaves out finer
/// detail.
namespace motorcade::synth {

inline std::uint32_t mix(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352dU;
  x ^= x >> 15;
  x *= 0x846ca68bU;
  return x ^ (x >> 16);
}
inline std::uint32_t hashOf(int x, int y, std::uint32_t seed) {
  return mix(static_cast<std::uint32_t>(x) * 0x9e3779b1U ^
             (static_cast<std::uint32_t>(y) * 0x85ebca77U + seed * 0xc2b2ae3dU));
}
inline std::uint32_t hashOf(int x, int y, int z, std::uint32_t seed) {
  return hashOf(x, y, seed + static_cast<std::uint32_t>(z) * 0x27d4eb2fU);
}
/// A hash as a number in [0, 1).
inline float unit(std::uint32_t hash) { return static_cast<float>(hash >> 8) * 0x1p-24F; }

inline float saturate(float x) { return x < 0 ? 0 : x > 1 ? 1 : x; }
inline float lerp(float a, float b, float t) { return a + (b - a) * t; }

/// Box-filtered indicator of [from, to] at x, seen through a window of width `footprint`.
inline float inside(float x, float from, float to, float footprint) {
  const float half = 0.5F * footprint;
  const float covered = std::fmin(x + half, to) - std::fmax(x - half, from);
  return saturate(covered / std::fmin(footprint + 1e-6F, to - from + footprint + 1e-6F));
}
/// Box-filtered pulse train: 1 on the first `width` of each `period`.
float pulses(float x, float period, float width, float footprint);

/// Smooth noise in [-1, 1] on a lattice of spacing one.
float noise2(float x, float y, std::uint32_t seed);
float noise3(float x, float y, float z, std::uint32_t seed);

/// Weight of a lattice noise with `spacing`: none below 1.2 footprints, all above 2.4.
inline float visible(float spacing, float footprint) {
  return saturate((spacing - 1.2F * footprint) / (1.2F * footprint + 1e-9F));
}

/// A sum of lattice noises, each half as wide and `gain` times as strong as the one before.
struct Fractal {
  float spacing;  // of the first lattice
  int octaves;    // number of noises, at most 8
  float gain;
};
/// Its value at a point; octaves too fine for the footprint fade out.
float fractal2(float x, float y, const Fractal& fractal, float footprint, std::uint32_t seed);
float fractal3(float x, float y, float z, const Fractal& fractal, float footprint, std::uint32_t seed);

/// A normal number: the sum of four uniform ones is near enough.
inline float gaussian(std::uint32_t hash) {
  const std::uint32_t other = mix(hash ^ 0x68bc21ebU);
  const auto low = [](std::uint32_t h) { return static_cast<float>(h & 0xffffU) * 0x1p-16F; };
  const float sum = low(hash) + low(hash >> 16) + low(other) + low(other >> 16);
  return (sum - 2) * 1.7320508F;
}

/// A sequence of random numbers for building a scene. An expression draws at most one of them: C++ leaves the order of
/// a call's arguments to the compiler, and another order of the draws makes another scene.
class Random {
 public:
  explicit Random(std::uint32_t seed) : seed_(seed) {}
  std::uint32_t bits() { return hashOf(static_cast<int>(++count_), 77, seed_); }
  float uniform(float from, float to) { return lerp(from, to, unit(bits())); }
  bool chance(float probability) { return unit(bits()) < probability; }

 private:
  std::uint32_t seed_, count_ = 0;
};

}  // namespace motorcade::synth
