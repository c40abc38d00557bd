#include "frontend/image/window_differences.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

#include "frontend/image/word_lanes.hpp"

namespace motorcade {
namespace {

/// A size that the compiler knows, or one that it does not: then the template's is zero.
template <int kColumns, int kRows>
class Differences {
 public:
  Differences(const Image& image, int u, int v, WindowSize window) : window_(window) {
    for (int r = 0, i = 0; r < rows(); ++r) {
      const std::uint8_t* row = image.row(v - rows() / 2 + r) + u - columns() / 2;
      for (int c = 0; c < columns(); ++c) sum_ += pixels_[i++] = row[c];
    }
  }

  /// Costs of sixteen neighboring windows, the first pixel of the first at `from`.
  Words operator()(const std::uint8_t* from, std::ptrdiff_t stride) const {
    const Words per_pixel = allWords(std::min((1 << 15) / (columns() * rows()), INT16_MAX));
    const Words offset = scaled(windowSums(from, stride) - static_cast<std::int16_t>(sum_), per_pixel);
    Words cost{};
    for (int r = 0, i = 0; r < rows(); ++r) {
      const std::uint8_t* row = from + r * stride;
      for (int c = 0; c < columns(); ++c) cost += magnitude(wordPixels(row + c) - (offset + pixels_[i++]));
    }
    return cost;
  }

 private:
  int columns() const { return kColumns > 0 ? kColumns : window_.columns; }
  int rows() const { return kRows > 0 ? kRows : window_.rows; }

  /// Sums of sixteen neighboring windows' pixels.
  Words windowSums(const std::uint8_t* from, std::ptrdiff_t stride) const {
    // Of each column first, over 32 columns: reads up to 31 bytes past a window's first pixel, the next row or the room
    // after the last.
    alignas(32) std::array<std::int16_t, 2 * kWordLanes> sums_of_columns;
    for (int c = 0; c < 2 * kWordLanes; c += kWordLanes) {
      Words sum{};
      for (int r = 0; r < rows(); ++r) sum += wordPixels(from + r * stride + c);
      storeWords(sums_of_columns.data() + c, sum);
    }
    Words sums{};
    for (int c = 0; c < columns(); ++c) sums += loadWords(sums_of_columns.data() + c);
    return sums;
  }

  WindowSize window_;
  std::array<std::int16_t, kMaxWindowPixels> pixels_;
  int sum_ = 0;
};

template <int kColumns, int kRows>
void fillCosts(const Image& image, int u, int v, const std::uint8_t* from, std::ptrdiff_t stride, WindowSize window,
               std::span<std::uint16_t> costs) {
  const Differences<kColumns, kRows> differences(image, u, v, window);
  const int count = static_cast<int>(costs.size());
  for (int first = 0; first < count; first += kWordLanes) {
    const Words cost = differences(from + first, stride);
    std::memcpy(costs.data() + first, &cost,
                static_cast<std::size_t>(std::min(kWordLanes, count - first)) * sizeof(std::uint16_t));
  }
}

}  // namespace

void windowDifferences(const Image& image, int u, int v, const Image& other, int other_u, int other_v,
                       WindowSize window, std::span<std::uint16_t> costs) {
  assert(fits(window));
  const std::uint8_t* from = other.row(other_v - window.rows / 2) + other_u - window.columns / 2;
  const auto fill = window == WindowSize{9, 5}    ? fillCosts<9, 5>
                    : window == WindowSize{11, 7} ? fillCosts<11, 7>
                                                  : fillCosts<0, 0>;
  fill(image, u, v, from, other.stride(), window, costs);
}

}  // namespace motorcade
