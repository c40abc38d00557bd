#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#ifdef __AVX2__
#include <immintrin.h>
#endif

/// Vectors of sixteen 16-bit integers by the compilers' vector extension, whose arithmetic is element by element. The
/// operations that it lacks (or that GCC 12 turns into scalar code) are here, with the same values in the portable
/// build.
namespace motorcade {

inline constexpr int kWordLanes = 16;
using Words = std::int16_t __attribute__((vector_size(2 * kWordLanes)));
using WordSums = std::int32_t __attribute__((vector_size(2 * kWordLanes)));  // one for two words

using FourSums = std::int32_t __attribute__((vector_size(16)));

inline Words loadWords(const std::int16_t* p) {
  Words words;
  std::memcpy(&words, p, sizeof words);
  return words;
}
inline void storeWords(std::int16_t* p, const Words& words) { std::memcpy(p, &words, sizeof words); }
inline Words allWords(int value) { return Words{} + static_cast<std::int16_t>(value); }

/// Words from 0 to 255.
inline void storeWordsAsBytes(std::uint8_t* p, const Words& words) {
  using Halves = std::uint8_t __attribute__((vector_size(kWordLanes)));
  const auto bytes = __builtin_convertvector(words, Halves);
  std::memcpy(p, &bytes, sizeof bytes);
}

#ifdef __AVX2__
inline Words wordPixels(const std::uint8_t* p) {
  return Words(_mm256_cvtepu8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p))));
}
/// Eight pixels from each of two places.
inline Words wordPixels(const std::uint8_t* p, const std::uint8_t* q) {
  const __m128i first = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(p)),
                second = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(q));
  return Words(_mm256_cvtepu8_epi16(_mm_unpacklo_epi64(first, second)));
}
inline Words magnitude(const Words& x) { return Words(_mm256_abs_epi16(__m256i(x))); }
/// Products of the words, added in pairs.
inline WordSums products(const Words& a, const Words& b) { return WordSums(_mm256_madd_epi16(__m256i(a), __m256i(b))); }
/// a b / 2^15, rounded.
inline Words scaled(const Words& a, const Words& b) { return Words(_mm256_mulhrs_epi16(__m256i(a), __m256i(b))); }
/// The words moved down by one or two lanes; zeros follow.
inline Words afterFirst(const Words& x) {
  const __m256i upper = _mm256_permute2x128_si256(__m256i(x), __m256i(x), 0x81);
  return Words(_mm256_alignr_epi8(upper, __m256i(x), 2));
}
inline Words afterSecond(const Words& x) {
  const __m256i upper = _mm256_permute2x128_si256(__m256i(x), __m256i(x), 0x81);
  return Words(_mm256_alignr_epi8(upper, __m256i(x), 4));
}
inline FourSums totals(const WordSums& a, const WordSums& b, const WordSums& c, const WordSums& d) {
  const __m256i pairs =
      _mm256_hadd_epi32(_mm256_hadd_epi32(__m256i(a), __m256i(b)), _mm256_hadd_epi32(__m256i(c), __m256i(d)));
  return FourSums(_mm_add_epi32(_mm256_castsi256_si128(pairs), _mm256_extracti128_si256(pairs, 1)));
}
/// Of words that are not negative.
inline std::int16_t leastOf(const Words& x) {
  const __m128i half = _mm_min_epi16(_mm256_castsi256_si128(__m256i(x)), _mm256_extracti128_si256(__m256i(x), 1));
  return static_cast<std::int16_t>(_mm_cvtsi128_si32(_mm_minpos_epu16(half)));
}
/// The first lane of a value; kWordLanes when none has it.
inline int firstOf(const Words& x, std::int16_t value) {
  const __m256i same = _mm256_cmpeq_epi16(__m256i(x), _mm256_set1_epi16(value));
  return std::countr_zero(static_cast<std::uint32_t>(_mm256_movemask_epi8(same))) / 2;
}
/// Sums of the absolute differences between the eight bytes from `eight` on and those from each of p, ..., p + 15 on.
inline Words differencesOfEight(const std::uint8_t* p, const std::uint8_t* eight) {
  std::int64_t bits;
  std::memcpy(&bits, eight, sizeof bits);
  const __m256i both = _mm256_set1_epi64x(bits);
  const auto* from = reinterpret_cast<const __m128i*>(p);
  const __m256i pixels =
      _mm256_set_m128i(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p + kWordLanes / 2)), _mm_loadu_si128(from));
  return Words(_mm256_mpsadbw_epu8(pixels, both, 0)) + Words(_mm256_mpsadbw_epu8(pixels, both, 0b101101));
}
#else
inline Words wordPixels(const std::uint8_t* p) {
  Words words;
  for (int i = 0; i < kWordLanes; ++i) words[i] = p[i];
  return words;
}
inline Words wordPixels(const std::uint8_t* p, const std::uint8_t* q) {
  Words words;
  for (int i = 0; i < kWordLanes; ++i) words[i] = i < kWordLanes / 2 ? p[i] : q[i - kWordLanes / 2];
  return words;
}
inline Words magnitude(const Words& x) { return x < 0 ? -x : x; }
inline WordSums products(const Words& a, const Words& b) {
  WordSums sums;
  for (int i = 0; i < kWordLanes / 2; ++i) sums[i] = a[2 * i] * b[2 * i] + a[2 * i + 1] * b[2 * i + 1];
  return sums;
}
inline Words scaled(const Words& a, const Words& b) {
  Words words;
  for (int i = 0; i < kWordLanes; ++i) words[i] = static_cast<std::int16_t>((a[i] * b[i] + (1 << 14)) >> 15);
  return words;
}
inline Words afterFirst(const Words& x) {
  Words words{};
  for (int i = 0; i + 1 < kWordLanes; ++i) words[i] = x[i + 1];
  return words;
}
inline Words afterSecond(const Words& x) { return afterFirst(afterFirst(x)); }
inline FourSums totals(const WordSums& a, const WordSums& b, const WordSums& c, const WordSums& d) {
  FourSums result{};
  for (int i = 0; i < kWordLanes / 2; ++i) result[0] += a[i], result[1] += b[i], result[2] += c[i], result[3] += d[i];
  return result;
}
inline std::int16_t leastOf(const Words& x) {
  std::int16_t least = x[0];
  for (int i = 1; i < kWordLanes; ++i) least = x[i] < least ? x[i] : least;
  return least;
}
inline int firstOf(const Words& x, std::int16_t value) {
  int lane = 0;
  while (lane < kWordLanes && x[lane] != value) ++lane;
  return lane;
}
inline Words differencesOfEight(const std::uint8_t* p, const std::uint8_t* eight) {
  Words sums{};
  for (int k = 0; k < 8; ++k) sums += magnitude(wordPixels(p + k) - static_cast<std::int16_t>(eight[k]));
  return sums;
}
#endif

/// `words` divided by 2^shift, rounded.
inline Words reduced(const Words& words, int shift) {
  return (words + allWords(1 << (shift - 1))) >> static_cast<std::int16_t>(shift);
}

}  // namespace motorcade
