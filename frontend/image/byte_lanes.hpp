#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#ifdef __AVX2__
#include <immintrin.h>
#endif

/// Vectors of 32 bytes by the compilers' vector extension, whose arithmetic is element by element. The operations that
/// it lacks (or that GCC 12 turns into scalar code) are here, with the same values in the portable build.
namespace motorcade {

inline constexpr int kByteLanes = 32;
using Bytes = std::uint8_t __attribute__((vector_size(kByteLanes)));

inline Bytes loadBytes(const std::uint8_t* p) {
  Bytes bytes;
  std::memcpy(&bytes, p, sizeof bytes);
  return bytes;
}
inline void storeBytes(std::uint8_t* p, const Bytes& bytes) { std::memcpy(p, &bytes, sizeof bytes); }
inline Bytes allBytes(std::uint8_t value) { return Bytes{} + value; }

#ifdef __AVX2__
inline Bytes lesser(const Bytes& a, const Bytes& b) { return Bytes(_mm256_min_epu8(__m256i(a), __m256i(b))); }
inline Bytes greater(const Bytes& a, const Bytes& b) { return Bytes(_mm256_max_epu8(__m256i(a), __m256i(b))); }
inline std::uint8_t leastOf(const Bytes& x) {
  const __m128i half = _mm_min_epu8(_mm256_castsi256_si128(__m256i(x)), _mm256_extracti128_si256(__m256i(x), 1));
  const __m128i pairs = _mm_min_epu8(half, _mm_srli_epi16(half, 8));
  return static_cast<std::uint8_t>(_mm_cvtsi128_si32(_mm_minpos_epu16(_mm_and_si128(pairs, _mm_set1_epi16(0xFF)))));
}
/// The first lane of a value; kByteLanes when none has it.
inline int firstOf(const Bytes& x, std::uint8_t value) {
  const __m256i same = _mm256_cmpeq_epi8(__m256i(x), __m256i(allBytes(value)));
  return std::countr_zero(static_cast<std::uint32_t>(_mm256_movemask_epi8(same)));
}
/// How many bits are set in each byte.
inline Bytes bitCounts(const Bytes& x) {
  const __m256i of_nibble = _mm256_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4,  //
                                             0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4);
  const __m256i low = _mm256_set1_epi8(0x0F), high = _mm256_and_si256(_mm256_srli_epi16(__m256i(x), 4), low);
  return Bytes(_mm256_add_epi8(_mm256_shuffle_epi8(of_nibble, _mm256_and_si256(__m256i(x), low)),
                               _mm256_shuffle_epi8(of_nibble, high)));
}
#else
inline Bytes lesser(const Bytes& a, const Bytes& b) {
  Bytes result;
  for (int i = 0; i < kByteLanes; ++i) result[i] = std::min(a[i], b[i]);
  return result;
}
inline Bytes greater(const Bytes& a, const Bytes& b) {
  Bytes result;
  for (int i = 0; i < kByteLanes; ++i) result[i] = std::max(a[i], b[i]);
  return result;
}
inline std::uint8_t leastOf(const Bytes& x) {
  std::uint8_t least = x[0];
  for (int i = 1; i < kByteLanes; ++i) least = std::min(least, x[i]);
  return least;
}
inline int firstOf(const Bytes& x, std::uint8_t value) {
  int lane = 0;
  while (lane < kByteLanes && x[lane] != value) ++lane;
  return lane;
}
inline Bytes bitCounts(const Bytes& x) {
  Bytes result;
  for (int i = 0; i < kByteLanes; ++i) result[i] = static_cast<std::uint8_t>(std::popcount(x[i]));
  return result;
}
#endif

}  // namespace motorcade
