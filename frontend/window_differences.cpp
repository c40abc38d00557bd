#include "frontend/window_differences.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace motorcade {
namespace {

// Vectors of the compilers' own kind; GCC 12 turns their widening of bytes into scalar code, hence the intrinsics.
using Words = std::int16_t __attribute__((vector_size(32)));
constexpr int kWordLanes = 16;
using WordFloats = float __attribute__((vector_size(4 * kWordLanes)));

#ifdef __AVX2__
inline Words wordPixels(const std::uint8_t* p) { return Words(_mm256_cvtepu8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)))); }
inline Words magnitude(const Words& x) { return Words(_mm256_abs_epi16(__m256i(x))); }
#else
inline Words wordPixels(const std::uint8_t* p) {
  Words words;
  for (int i = 0; i < kWordLanes; ++i) words[i] = p[i];
  return words;
}
inline Words magnitude(const Words& x) { return x < 0 ? -x : x; }
#endif

inline Words words(const std::int16_t* p) {
  Words words;
  std::memcpy(&words, p, sizeof words);
  return words;
}

}  // namespace

void windowDifferences(const Image& image, int u, int v, const Image& other, int other_u, int other_v, WindowSize window,
                       std::span<std::uint16_t> costs) {
  assert(fits(window));
  const int half_columns = window.columns / 2, half_rows = window.rows / 2, count = static_cast<int>(costs.size());
  const float per_pixel = 1 / static_cast<float>(window.columns * window.rows);
  const std::uint8_t* own = image.row(v - half_rows) + u - half_columns;
  // Their pixels as words, row by row, and the columns' sums: what sixteen neighbouring windows read.
  constexpr int kReadColumns = 2 * kWordLanes;
  alignas(32) std::array<std::int16_t, kReadColumns * kMaxWindowRows> theirs;
  alignas(32) std::array<std::int16_t, kReadColumns> column_sums;
  int own_sum = 0;
  for (int r = 0; r < window.rows; ++r)
    for (int c = 0; c < window.columns; ++c) own_sum += own[r * image.stride() + c];
  for (int first = 0; first < count; first += kWordLanes) {
    // Reads up to 31 bytes past a window's first pixel: the next row, or the room that each image has after its last.
    const std::uint8_t* from = other.row(other_v - half_rows) + other_u - half_columns + first;
    for (int c = 0; c < kReadColumns; c += kWordLanes) {
      Words sum{};
      for (int r = 0; r < window.rows; ++r) {
        const Words pixel_words = wordPixels(from + r * other.stride() + c);
        std::memcpy(theirs.data() + r * kReadColumns + c, &pixel_words, sizeof pixel_words);
        sum += pixel_words;
      }
      std::memcpy(column_sums.data() + c, &sum, sizeof sum);
    }
    Words brighter = Words{} - static_cast<std::int16_t>(own_sum);  // sum of their pixels minus ours
    for (int c = 0; c < window.columns; ++c) brighter += words(column_sums.data() + c);
    const Words offset = __builtin_convertvector(__builtin_convertvector(brighter, WordFloats) * per_pixel, Words);
    Words cost{};
    for (int r = 0; r < window.rows; ++r)
      for (int c = 0; c < window.columns; ++c)
        cost += magnitude(words(theirs.data() + r * kReadColumns + c) - offset - static_cast<std::int16_t>(own[r * image.stride() + c]));
    std::memcpy(costs.data() + first, &cost, static_cast<std::size_t>(std::min(kWordLanes, count - first)) * sizeof(std::uint16_t));
  }
}

}  // namespace motorcade
