#include "frontend/image/window_differences.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "frontend/image/window_differences.cpp"
#include <hwy/foreach_target.h>

#include "frontend/image/pixel_lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

constexpr int kColumnLanes = 2 * kWordLanes;  // columns that sixteen neighboring windows may span

/// Compares a window with sixteen neighboring ones at a time.
template <WindowSize Size>
class Differences {
  static constexpr int kColumns = Size.columns, kRows = Size.rows, kPixels = kColumns * kRows;
  static_assert(kColumns - 1 <= kColumnLanes - kWordLanes);
  static_assert(kPixels * UINT8_MAX <= INT16_MAX);  // a word holds the sum over a window

 public:
  explicit Differences(const Window& window) {
    const Words inside = wordNumbers() < allWords(kColumns);  // minus one
    WordSums sums{};
    for (int r = 0; r < kRows; ++r) {
      const Words pixels = wordPixels(window.image.row(window.v - kRows / 2 + r) + window.u - kColumns / 2);
      store(pixels_.data() + r * kWordLanes, pixels);
      sums -= products(pixels, inside);
    }
    sum_ = total(sums);
  }

  /// Costs of sixteen neighboring windows, the first pixel of the first at `from`.
  Words operator()(const std::uint8_t* from, std::ptrdiff_t stride) const {
    const Words per_pixel = allWords((1 << 15) / kPixels);  // as `scaled` takes fractions
    const Words offset = scaled(windowSums(from, stride) - allWords(sum_), per_pixel);
    Words cost{};
    for (int r = 0; r < kRows; ++r) {
      const std::uint8_t* row = from + r * stride;
      for (int c = 0; c < kColumns; ++c)
        cost += magnitude(wordPixels(row + c) - (offset + Words(pixels_[r * kWordLanes + c])));
    }
    return cost;
  }

 private:
  /// Sums of the pixels of sixteen neighboring windows.
  static Words windowSums(const std::uint8_t* from, std::ptrdiff_t stride) {
    // The sums of 32 columns come first. This reads up to 31 bytes past a window's first pixel: of the next row, or of
    // the room that an image keeps after its last row.
    alignas(32) std::array<std::int16_t, kColumnLanes> sums_of_columns;
    for (int c = 0; c < kColumnLanes; c += kWordLanes) {
      Words sum{};
      for (int r = 0; r < kRows; ++r) sum += wordPixels(from + r * stride + c);
      store(sums_of_columns.data() + c, sum);
    }
    Words sums{};
    for (int c = 0; c < kColumns; ++c) sums += load(sums_of_columns.data() + c);
    return sums;
  }

  std::array<std::int16_t, kRows * kWordLanes> pixels_;  // row by row, with what lies to the right
  int sum_ = 0;
};

template <WindowSize Size>
void fillCosts(const Window& window, const std::uint8_t* from, std::ptrdiff_t stride, std::span<std::uint16_t> costs,
               std::uint32_t blocks) {
  const Differences<Size> differences(window);
  const int count = static_cast<int>(costs.size());
  for (int first = 0; first < count; first += kWordLanes, blocks >>= 1) {
    if ((blocks & 1) == 0) continue;
    const Words cost = differences(from + first, stride);
    if (first + kWordLanes <= count)
      std::memcpy(costs.data() + first, &cost, sizeof cost);
    else
      std::memcpy(costs.data() + first, &cost, (count - first) * sizeof(std::uint16_t));
  }
}

}  // namespace

void fillDifferences(const Window& window, const Image& other, int other_u, int other_v, std::span<std::uint16_t> costs,
                     std::uint32_t blocks) {
  assert(window.size == kHalfSizeWindow || window.size == kFullSizeWindow);
  const std::uint8_t* from = other.row(other_v - window.size.rows / 2) + other_u - window.size.columns / 2;
  const auto fill = window.size == kHalfSizeWindow ? fillCosts<kHalfSizeWindow> : fillCosts<kFullSizeWindow>;
  fill(window, from, other.stride(), costs, blocks);
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(fillDifferences);

void windowDifferences(const Window& window, const Image& other, int other_u, int other_v,
                       std::span<std::uint16_t> costs, std::uint32_t blocks) {
  MOTORCADE_KERNEL(fillDifferences)(window, other, other_u, other_v, costs, blocks);
}

}  // namespace motorcade
#endif
