#include "apps/synth/shapes/noise.hpp"

#include <cassert>

#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "apps/synth/shapes/noise.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace motorcade::synth::HWY_NAMESPACE {
namespace {

/// Several lanes at once, by the compiler's vector types.
template <int N>
struct Lanes {
  using Float __attribute__((vector_size(4 * N))) = float;
  using Int __attribute__((vector_size(4 * N))) = std::int32_t;
  using Bits __attribute__((vector_size(4 * N))) = std::uint32_t;
};

template <class T>
[[gnu::always_inline]] inline T fade(const T& t) {
  return t * t * (3 - 2 * t);
}
template <class T>
[[gnu::always_inline]] inline T between(const T& a, const T& b, const T& t) {
  return a + (b - a) * t;
}

/// A coordinate of each lane as a lattice cell and the position in it.
template <int N>
struct Cell {
  typename Lanes<N>::Bits cell;
  typename Lanes<N>::Float blend;
};
template <int N>
[[gnu::always_inline]] inline Cell<N> cellOf(const typename Lanes<N>::Float& x) {
  using Float = typename Lanes<N>::Float;
  using Int = typename Lanes<N>::Int;
  Int whole = __builtin_convertvector(x, Int);
  whole += x < __builtin_convertvector(whole, Float);  // true is -1: rounds down
  const Float rest = x - __builtin_convertvector(whole, Float);
  return {reinterpret_cast<typename Lanes<N>::Bits>(whole), fade(rest)};
}

constexpr std::uint32_t kX = 0x9e3779b1U, kY = 0x85ebca77U, kSeed = 0xc2b2ae3dU, kZ = 0x27d4eb2fU;  // as in hashOf

/// mix(bits) as a number in [-1, 1).
template <int N>
[[gnu::always_inline]] inline typename Lanes<N>::Float value(typename Lanes<N>::Bits h) {
  h ^= h >> 16;
  h *= 0x7feb352dU;
  h ^= h >> 15;
  h *= 0x846ca68bU;
  h ^= h >> 16;
  return __builtin_convertvector(reinterpret_cast<typename Lanes<N>::Int>(h >> 8), typename Lanes<N>::Float) *
             0x1p-23F -
         1.0F;
}

/// noise2 with another point and seed in each lane.
template <int N>
[[gnu::always_inline]] inline typename Lanes<N>::Float planeNoise(const Cell<N>& x, const Cell<N>& y,
                                                                  const typename Lanes<N>::Bits& seed) {
  const typename Lanes<N>::Bits x0 = x.cell * kX, y0 = y.cell * kY + seed * kSeed;
  return between(between(value<N>(x0 ^ y0), value<N>((x0 + kX) ^ y0), x.blend),
                 between(value<N>(x0 ^ (y0 + kY)), value<N>((x0 + kX) ^ (y0 + kY)), x.blend), y.blend);
}

/// A fractal as a pixel sees it.
struct SeenFractal {
  float spacing, gain, footprint;
  int octaves;
  std::uint32_t seed;
  SeenFractal(const Fractal& fractal, float pixel_footprint, std::uint32_t first_seed)
      : spacing(fractal.spacing),
        gain(fractal.gain),
        footprint(pixel_footprint),
        octaves(fractal.octaves),
        seed(first_seed) {
    assert(octaves <= 8);
  }
  bool reaches(int octave) const {
    return octaves > octave && visible(spacing / static_cast<float>(1 << octave), footprint) > 0;
  }
};

/// One octave in each lane.
template <int N>
struct Octaves {
  typename Lanes<N>::Float per_spacing, weight;
  typename Lanes<N>::Bits seed;

  [[gnu::always_inline]] explicit Octaves(const SeenFractal& f) {
    using Float = typename Lanes<N>::Float;
    const float gain2 = f.gain * f.gain, gain4 = gain2 * gain2, floor = 1.2F * f.footprint;
    Float twice, amplitude, number;
    if constexpr (N == 4) {
      number = Float{0, 1, 2, 3};
      twice = Float{1, 2, 4, 8};
      amplitude = Float{1, f.gain, gain2, gain2 * f.gain};
    } else {
      number = Float{0, 1, 2, 3, 4, 5, 6, 7};
      twice = Float{1, 2, 4, 8, 16, 32, 64, 128};
      amplitude = Float{1, f.gain, gain2, gain2 * f.gain, gain4, gain4 * f.gain, gain4 * gain2, gain4 * gain2 * f.gain};
    }
    per_spacing = twice * (1 / f.spacing);
    const Float seen = (f.spacing / twice - floor) * (1 / (floor + 1e-9F)), none{};
    const Float part = seen < none ? none : seen > none + 1 ? none + 1 : seen;  // as visible()
    weight = number < none + static_cast<float>(f.octaves) ? part * amplitude : none;
    seed = f.seed + __builtin_convertvector(number, typename Lanes<N>::Bits);
  }
  [[gnu::always_inline]] float sum(const typename Lanes<N>::Float& noise) const {
    const typename Lanes<N>::Float terms = weight * noise;
    float all = 0;
    for (int i = 0; i < N; ++i) all += terms[i];
    return all;
  }
};

template <int N>
[[gnu::noinline]] float sum2(const SeenFractal& f, float x, float y) {
  const Octaves<N> octaves(f);
  return octaves.sum(
      planeNoise<N>(cellOf<N>(x * octaves.per_spacing), cellOf<N>(y * octaves.per_spacing), octaves.seed));
}

template <int N>
[[gnu::noinline]] float sum3(const SeenFractal& f, float x, float y, float z) {
  const Octaves<N> octaves(f);
  const Cell<N> cx = cellOf<N>(x * octaves.per_spacing), cy = cellOf<N>(y * octaves.per_spacing),
                cz = cellOf<N>(z * octaves.per_spacing);
  const typename Lanes<N>::Bits below = octaves.seed + cz.cell * kZ;
  return octaves.sum(between(planeNoise<N>(cx, cy, below), planeNoise<N>(cx, cy, below + kZ), cz.blend));
}

}  // namespace

float noiseOf3(float x, float y, float z, std::uint32_t seed) {
  const float fx = std::floor(x), fy = std::floor(y), fz = std::floor(z);
  const auto bits = [](float whole) HWY_ATTR { return static_cast<std::uint32_t>(static_cast<int>(whole)); };
  const std::uint32_t x0 = bits(fx) * kX, y0 = bits(fy) * kY + (seed + bits(fz) * kZ) * kSeed, up = kZ * kSeed;
  const std::uint32_t x1 = x0 + kX, y1 = y0 + kY;
  const Lanes<8>::Float v = value<8>(Lanes<8>::Bits{x0, x1, x0, x1, x0, x1, x0, x1} ^
                                     Lanes<8>::Bits{y0, y0, y1, y1, y0 + up, y0 + up, y1 + up, y1 + up});
  const float tx = fade(x - fx), ty = fade(y - fy), tz = fade(z - fz);
  return lerp(lerp(lerp(v[0], v[1], tx), lerp(v[2], v[3], tx), ty),
              lerp(lerp(v[4], v[5], tx), lerp(v[6], v[7], tx), ty), tz);
}

float fractalOf2(float x, float y, const Fractal& fractal, float footprint, std::uint32_t seed) {
  const SeenFractal seen(fractal, footprint, seed);
  if (!seen.reaches(0)) return 0;
  return seen.reaches(4) ? sum2<8>(seen, x, y) : sum2<4>(seen, x, y);
}

float fractalOf3(float x, float y, float z, const Fractal& fractal, float footprint, std::uint32_t seed) {
  const SeenFractal seen(fractal, footprint, seed);
  if (!seen.reaches(0)) return 0;
  return seen.reaches(4) ? sum3<8>(seen, x, y, z) : sum3<4>(seen, x, y, z);
}

}  // namespace motorcade::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade::synth {

MOTORCADE_EXPORT(noiseOf3);
MOTORCADE_EXPORT(fractalOf2);
MOTORCADE_EXPORT(fractalOf3);

namespace {

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

float noise2(float x, float y, std::uint32_t seed) { return fractal2(x, y, {1, 1, 1}, 0, seed); }

float noise3(float x, float y, float z, std::uint32_t seed) { return MOTORCADE_KERNEL(noiseOf3)(x, y, z, seed); }

float fractal2(float x, float y, const Fractal& fractal, float footprint, std::uint32_t seed) {
  return MOTORCADE_KERNEL(fractalOf2)(x, y, fractal, footprint, seed);
}

float fractal3(float x, float y, float z, const Fractal& fractal, float footprint, std::uint32_t seed) {
  return MOTORCADE_KERNEL(fractalOf3)(x, y, z, fractal, footprint, seed);
}

}  // namespace motorcade::synth
#endif
