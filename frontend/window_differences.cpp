#include "frontend/window_differences.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

#include "frontend/word_lanes.hpp"

namespace motorcade {
namespace {

/// The pixels of one window, row by row.
struct Window {
  std::array<std::int16_t, kMaxWindowPixels> pixels;
  int sum = 0;
};

/// Sums of sixteen neighbouring windows' pixels, the first at `from`.
Words windowSums(const std::uint8_t* from, std::ptrdiff_t stride, WindowSize window) {
  // Of each column first, over 32 columns: reads up to 31 bytes past a window's first pixel, the next row or the room after the last.
  alignas(32) std::array<std::int16_t, 2 * kWordLanes> columns;
  for (int c = 0; c < 2 * kWordLanes; c += kWordLanes) {
    Words sum{};
    for (int r = 0; r < window.rows; ++r) sum += wordPixels(from + r * stride + c);
    storeWords(columns.data() + c, sum);
  }
  Words sums{};
  for (int c = 0; c < window.columns; ++c) sums += loadWords(columns.data() + c);
  return sums;
}

}  // namespace

void windowDifferences(const Image& image, int u, int v, const Image& other, int other_u, int other_v, WindowSize window,
                       std::span<std::uint16_t> costs) {
  assert(fits(window));
  const int half_columns = window.columns / 2, half_rows = window.rows / 2, count = static_cast<int>(costs.size());
  const Words per_pixel = allWords(std::min((1 << 15) / (window.columns * window.rows), INT16_MAX));
  Window own;
  for (int r = 0, i = 0; r < window.rows; ++r) {
    const std::uint8_t* row = image.row(v - half_rows + r) + u - half_columns;
    for (int c = 0; c < window.columns; ++c) own.sum += own.pixels[static_cast<std::size_t>(i++)] = row[c];
  }
  for (int first = 0; first < count; first += kWordLanes) {
    const std::uint8_t* from = other.row(other_v - half_rows) + other_u - half_columns + first;
    const Words offset = scaled(windowSums(from, other.stride(), window) - static_cast<std::int16_t>(own.sum), per_pixel);
    Words cost{};
    for (int r = 0, i = 0; r < window.rows; ++r) {
      const std::uint8_t* row = from + r * other.stride();
#pragma GCC unroll 4
      for (int c = 0; c < window.columns; ++c)
        cost += magnitude(wordPixels(row + c) - (offset + own.pixels[static_cast<std::size_t>(i++)]));
    }
    std::memcpy(costs.data() + first, &cost, static_cast<std::size_t>(std::min(kWordLanes, count - first)) * sizeof(std::uint16_t));
  }
}

}  // namespace motorcade
