#pragma once

#include <cstdint>
#include <cstring>
#ifdef __AVX2__
#include <immintrin.h>
#endif

/// Vectors of eight floats by the compilers' vector extension, to compare a value with many, and of four, to compute
/// values that are alike. The operations that it lacks are here, with the same values in the portable build.
namespace motorcade {

inline constexpr int kFloatLanes = 8;
using Floats = float __attribute__((vector_size(4 * kFloatLanes)));
using FloatMask = std::int32_t __attribute__((vector_size(4 * kFloatLanes)));  // all bits set where it holds

using FourFloats = float __attribute__((vector_size(16)));

inline FourFloats allFour(float value) { return FourFloats{value, value, value, value}; }
inline Floats loadFloats(const float* p) {
  Floats floats;
  std::memcpy(&floats, p, sizeof floats);
  return floats;
}
inline Floats allFloats(float value) { return Floats{} + value; }
inline Floats lesser(const Floats& a, const Floats& b) { return a < b ? a : b; }
inline Floats greater(const Floats& a, const Floats& b) { return a > b ? a : b; }

#ifdef __AVX2__
inline bool anyOf(const FloatMask& mask) { return _mm256_testz_si256(__m256i(mask), __m256i(mask)) == 0; }
/// A bit for each lane, that of the first one being the lowest.
inline unsigned bitsOf(const FloatMask& mask) { return static_cast<unsigned>(_mm256_movemask_ps(__m256(mask))); }
#else
inline bool anyOf(const FloatMask& mask) {
  std::int32_t bits = 0;
  for (int i = 0; i < kFloatLanes; ++i) bits |= mask[i];
  return bits != 0;
}
inline unsigned bitsOf(const FloatMask& mask) {
  unsigned bits = 0;
  for (int i = 0; i < kFloatLanes; ++i) bits |= (mask[i] == 0 ? 0U : 1U) << i;
  return bits;
}
#endif

}  // namespace motorcade
