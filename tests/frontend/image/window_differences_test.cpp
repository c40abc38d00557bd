#include "frontend/image/window_differences.hpp"

#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

/// One cost as the header defines it, pixel by pixel.
int differenceByPixels(const Window& window, const Image& other, int other_u, int other_v) {
  const int columns = window.size.columns, rows = window.size.rows, pixels = columns * rows;
  const auto difference = [&](int i) {
    const int du = i % columns - columns / 2, dv = i / columns - rows / 2;
    return other.at(other_u + du, other_v + dv) - window.image.at(window.u + du, window.v + dv);
  };
  int brighter = 0, sum = 0;
  for (int i = 0; i < pixels; ++i) brighter += difference(i);
  const int offset = (brighter * (32768 / pixels) + 16384) >> 15;  // the difference of the means, rounded
  for (int i = 0; i < pixels; ++i) sum += std::abs(difference(i) - offset);
  return sum;
}

TEST(WindowDifferences, MatchTheirDefinition) {
  const Image a = test::render(80, 40, test::Texture(31)),
              b = test::render(80, 40, test::Texture(31), {.gain = 1, .bias = 20, .noise = 3});
  for (const WindowSize size : {kHalfSizeWindow, kFullSizeWindow}) {
    const Window window{a, 40, 20, size};
    std::vector<std::uint16_t> costs(53);
    windowDifferences(window, b, 12, 21, costs);
    for (int i = 0; i < 53; ++i) EXPECT_EQ(costs[i], differenceByPixels(window, b, 12 + i, 21));
  }
}

TEST(WindowDifferences, AWindowLiesInsideItsImageUpToTheBorder) {
  const Image image = test::render(80, 40, test::Texture(31));
  EXPECT_TRUE((Window{image, 5, 3, kFullSizeWindow}.insideImage()));
  EXPECT_FALSE((Window{image, 4, 3, kFullSizeWindow}.insideImage()));
  EXPECT_FALSE((Window{image, 5, 2, kFullSizeWindow}.insideImage()));
  EXPECT_TRUE((Window{image, 74, 36, kFullSizeWindow}.insideImage()));
  EXPECT_FALSE((Window{image, 75, 36, kFullSizeWindow}.insideImage()));
  EXPECT_FALSE((Window{image, 74, 37, kFullSizeWindow}.insideImage()));
}

}  // namespace
}  // namespace motorcade
