/// Vectors of pixels (core/lanes.hpp), with operations of image processing that the compilers' vectors lack.
#if defined(MOTORCADE_PIXEL_LANES) == defined(HWY_TARGET_TOGGLE)
#ifdef MOTORCADE_PIXEL_LANES
#undef MOTORCADE_PIXEL_LANES
#else
#define MOTORCADE_PIXEL_LANES
#endif

#include "core/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {

using Bytes = Lanes<std::uint8_t>;
using Words = Lanes<std::int16_t>;
using WordSums = Lanes<std::int32_t>;  // one for two words: which two, depends on the target
using SixteenBytes = std::uint8_t __attribute__((vector_size(16)));
using EightWords = std::int16_t __attribute__((vector_size(16)));
using FourSums = std::int32_t __attribute__((vector_size(16)));

inline constexpr int kByteLanes = 32, kWordLanes = 16, kFloatLanes = 8;

// An operation on integers that SSE or AVX2 has, as wide as a part.
#undef MOTORCADE_X86
#if HWY_TARGET == HWY_AVX2
#define MOTORCADE_X86(operation, a, b) _mm256_##operation(__m256i(a), __m256i(b))
#else
#define MOTORCADE_X86(operation, a, b) _mm_##operation(__m128i(a), __m128i(b))
#endif
#undef MOTORCADE_SSE4
#define MOTORCADE_SSE4 (HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_SSE4)

HWY_INLINE Words allWords(int value) { return {static_cast<std::int16_t>(value)}; }
/// 0, 1, 2, ...
HWY_INLINE Words wordNumbers() {
  static constexpr std::int16_t kNumbers[]{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  return load(kNumbers);
}

HWY_INLINE Words widened(const SixteenBytes& bytes) {
  Words words;
#if HWY_TARGET == HWY_AVX2
  words.part[0] = Words::Part(_mm256_cvtepu8_epi16(__m128i(bytes)));
#else
  const SixteenBytes zero{};
  words.part[0] =
      Words::Part(__builtin_shufflevector(bytes, zero, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23));
  words.part[1] =
      Words::Part(__builtin_shufflevector(bytes, zero, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31));
#endif
  return words;
}
HWY_INLINE Words wordPixels(const std::uint8_t* p) {
  SixteenBytes bytes;
  std::memcpy(&bytes, p, sizeof bytes);
  return widened(bytes);
}
/// Eight pixels from each of two places.
HWY_INLINE Words wordPixels(const std::uint8_t* p, const std::uint8_t* q) {
  std::int64_t first, second;
  std::memcpy(&first, p, sizeof first);
  std::memcpy(&second, q, sizeof second);
  using Two = std::int64_t __attribute__((vector_size(16)));
  return widened(SixteenBytes(Two{first, second}));
}
/// Words from 0 to 255.
HWY_INLINE void storeWordsAsBytes(std::uint8_t* p, const Words& words) {
#if HWY_TARGET == HWY_AVX2
  const auto bytes = __builtin_convertvector(words.part[0], SixteenBytes);
#else
  const auto bytes = __builtin_shufflevector(SixteenBytes(words.part[0]), SixteenBytes(words.part[1]), 0, 2, 4, 6, 8,
                                             10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
#endif
  __builtin_memcpy(p, &bytes, sizeof bytes);
}

HWY_INLINE Words magnitude(const Words& x) {
#if HWY_TARGET == HWY_AVX2
  return Words::each<std::int16_t>(
      [](const Words::Part& part) HWY_ATTR { return Words::Part(_mm256_abs_epi16(__m256i(part))); }, x);
#elif HWY_ARCH_ARM
  return Words::each<std::int16_t>(
      [](const Words::Part& part) HWY_ATTR { return Words::Part(vabsq_s16(int16x8_t(part))); }, x);
#else
  return greater(x, -x);
#endif
}
/// Products of the words, added in pairs.
HWY_INLINE WordSums products(const Words& a, const Words& b) {
  return Words::each<std::int32_t>(
      [](const Words::Part& x, const Words::Part& y) HWY_ATTR {
#if HWY_ARCH_X86
        return WordSums::Part(MOTORCADE_X86(madd_epi16, x, y));
#else
        const int16x8_t u(x), v(y);
        return WordSums::Part(vmlal_high_s16(vmull_s16(vget_low_s16(u), vget_low_s16(v)), u, v));
#endif
      },
      a, b);
}
/// a b / 2^15, rounded.
HWY_INLINE Words scaled(const Words& a, const Words& b) {
  return Words::each<std::int16_t>(
      [](const Words::Part& x, const Words::Part& y) HWY_ATTR {
#if MOTORCADE_SSE4
        return Words::Part(MOTORCADE_X86(mulhrs_epi16, x, y));
#elif HWY_ARCH_X86
        const auto high = Words::Part(_mm_mulhi_epi16(__m128i(x), __m128i(y)));
        using Unsigned = Lanes<std::uint16_t>::Part;
        return high + high + Words::Part(((Unsigned(x * y) >> 14) + 1) >> 1);
#else
        return Words::Part(vqrdmulhq_s16(int16x8_t(x), int16x8_t(y)));
#endif
      },
      a, b);
}
/// `words` divided by 2^shift, rounded.
HWY_INLINE Words reduced(const Words& words, int shift) { return (words + allWords(1 << (shift - 1))) >> shift; }

HWY_INLINE FourSums totals(const WordSums& a, const WordSums& b, const WordSums& c, const WordSums& d) {
#if HWY_TARGET == HWY_AVX2
  const auto sums = [](const auto& x, const auto& y) HWY_ATTR { return MOTORCADE_X86(hadd_epi32, x, y); };
  const __m256i pairs = sums(sums(a.part[0], b.part[0]), sums(c.part[0], d.part[0]));
  return FourSums(_mm256_castsi256_si128(pairs)) + FourSums(_mm256_extracti128_si256(pairs, 1));
#elif HWY_ARCH_ARM
  const auto sums = [](const WordSums& x, const WordSums& y) HWY_ATTR {
    return vpaddq_s32(int32x4_t(x.part[0] + x.part[1]), int32x4_t(y.part[0] + y.part[1]));
  };
  return FourSums(vpaddq_s32(sums(a, b), sums(c, d)));
#else
  const auto sums = [](const WordSums& x, const WordSums& y) HWY_ATTR {
    const FourSums u = x.part[0] + x.part[1], v = y.part[0] + y.part[1];
    return __builtin_shufflevector(u, v, 0, 4, 1, 5) + __builtin_shufflevector(u, v, 2, 6, 3, 7);
  };
  const FourSums ab = sums(a, b), cd = sums(c, d);
  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
#endif
}
HWY_INLINE int total(const WordSums& x) { return totals(x, x, x, x)[0]; }

/// The least of words that are not negative.
HWY_INLINE std::int16_t leastOf(const Words& x) {
#if HWY_TARGET == HWY_AVX2
  EightWords least = EightWords(_mm256_castsi256_si128(__m256i(x.part[0])));
  const EightWords other = EightWords(_mm256_extracti128_si256(__m256i(x.part[0]), 1));
#else
  EightWords least = x.part[0];
  const EightWords other = x.part[1];
#endif
  least = least < other ? least : other;
#if MOTORCADE_SSE4
  return static_cast<std::int16_t>(_mm_cvtsi128_si32(_mm_minpos_epu16(__m128i(least))));
#elif HWY_ARCH_ARM
  return vminvq_s16(int16x8_t(least));
#else
  const auto takeLess = [&least](const EightWords& moved) HWY_ATTR { least = least < moved ? least : moved; };
  takeLess(__builtin_shufflevector(least, least, 4, 5, 6, 7, 0, 1, 2, 3));
  takeLess(__builtin_shufflevector(least, least, 2, 3, 0, 1, 4, 5, 6, 7));
  takeLess(__builtin_shufflevector(least, least, 1, 0, 2, 3, 4, 5, 6, 7));
  return least[0];
#endif
}

/// The number of bits that are set in each byte.
HWY_INLINE Bytes bitCounts(const Bytes& x) {
#if MOTORCADE_SSE4
  static constexpr std::uint8_t kOfNibble[]{0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4,
                                            0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4};
  const auto counts = [](const Bytes::Part& of_nibble, const Bytes::Part& nibbles)
                          HWY_ATTR { return Bytes::Part(MOTORCADE_X86(shuffle_epi8, of_nibble, nibbles)); };
  const Bytes of_nibble = load(kOfNibble), low = x & 0x0F, high = (x >> 4) & 0x0F;
  return Bytes::each<std::uint8_t>(counts, of_nibble, low) + Bytes::each<std::uint8_t>(counts, of_nibble, high);
#elif HWY_ARCH_ARM
  return Bytes::each<std::uint8_t>(
      [](const Bytes::Part& part) HWY_ATTR { return Bytes::Part(vcntq_u8(uint8x16_t(part))); }, x);
#else
  const Bytes of_two = x - ((x >> 1) & 0x55), of_four = (of_two & 0x33) + ((of_two >> 2) & 0x33);
  return (of_four + (of_four >> 4)) & 0x0F;
#endif
}

#if MOTORCADE_SSE4
/// Weighted sums of sixteen pairs of pixels. `pixels` says which, counted from `p` on and, for the last eight pairs,
/// from `q` on.
HWY_INLINE Words weighedPixels(const std::uint8_t* p, const std::uint8_t* q, const Bytes& pixels,
                               const Words& weights) {
  const auto sixteen = [](const std::uint8_t* at)
                           HWY_ATTR { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(at)); };
  Bytes from;
#if HWY_TARGET == HWY_AVX2
  from.part[0] = Bytes::Part(_mm256_inserti128_si256(_mm256_castsi128_si256(sixteen(p)), sixteen(q), 1));
#else
  from.part[0] = Bytes::Part(sixteen(p)), from.part[1] = Bytes::Part(sixteen(q));
#endif
  return Bytes::each<std::int16_t>(
      [](const Bytes::Part& x, const Bytes::Part& which, const Words::Part& w)
          HWY_ATTR { return Words::Part(MOTORCADE_X86(maddubs_epi16, MOTORCADE_X86(shuffle_epi8, x, which), w)); },
      from, pixels, weights);
}
#endif

/// Sum of the absolute differences.
HWY_INLINE int differenceOf(const SixteenBytes& a, const SixteenBytes& b) {
#if HWY_ARCH_X86
  const __m128i sums = _mm_sad_epu8(__m128i(a), __m128i(b));
  return _mm_cvtsi128_si32(_mm_add_epi32(sums, _mm_unpackhi_epi64(sums, sums)));
#else
  return vaddlvq_u8(vabdq_u8(uint8x16_t(a), uint8x16_t(b)));
#endif
}

/// Sums of the absolute differences between the eight bytes from `eight` on and those from each of p, ..., p + 15 on.
HWY_INLINE Words differencesOfEight(const std::uint8_t* p, const std::uint8_t* eight) {
#if HWY_TARGET == HWY_AVX2
  std::int64_t bits;
  std::memcpy(&bits, eight, sizeof bits);
  const __m256i both = _mm256_set1_epi64x(bits);
  const auto at = [p](int i) HWY_ATTR { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p + i)); };
  const __m256i pixels = _mm256_set_m128i(at(8), at(0));
  Words sums;
  sums.part[0] =
      Words::Part(_mm256_mpsadbw_epu8(pixels, both, 0)) + Words::Part(_mm256_mpsadbw_epu8(pixels, both, 0b101101));
  return sums;
#elif HWY_ARCH_X86
  const auto eightAt = [](const std::uint8_t* at)
                           HWY_ATTR { return _mm_loadl_epi64(reinterpret_cast<const __m128i*>(at)); };
  const __m128i once = eightAt(eight), both = _mm_unpacklo_epi64(once, once);
  Words sums;
  for (int i = 0; i < kParts; ++i) {
    const std::uint8_t* const from = p + 8 * i;
#if MOTORCADE_SSE4
    const __m128i pixels = _mm_loadu_si128(reinterpret_cast<const __m128i*>(from));
    sums.part[i] = Words::Part(_mm_mpsadbw_epu8(pixels, both, 0)) + Words::Part(_mm_mpsadbw_epu8(pixels, both, 0b101));
#else
    const auto two = [&](int k) HWY_ATTR {
      return _mm_sad_epu8(_mm_unpacklo_epi64(eightAt(from + k), eightAt(from + k + 1)), both);
    };
    sums.part[i] = Words::Part(_mm_packs_epi32(_mm_packs_epi32(two(0), two(2)), _mm_packs_epi32(two(4), two(6))));
#endif
  }
  return sums;
#else
  Words sums;
  for (int i = 0; i < kParts; ++i) {
    uint16x8_t sum = vdupq_n_u16(0);
    for (int k = 0; k < 8; ++k) sum = vabal_u8(sum, vld1_u8(p + 8 * i + k), vdup_n_u8(eight[k]));
    sums.part[i] = Words::Part(sum);
  }
  return sums;
#endif
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
