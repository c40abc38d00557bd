#include "frontend/image/window_differences.hpp"

#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

TEST(WindowDifferences, MatchTheirDefinition) {
  const Image a = test::render(80, 40, test::Texture(31)),
              b = test::render(80, 40, test::Texture(31), {.gain = 1, .bias = 20, .noise = 3});
  std::vector<std::uint16_t> costs(53);
  windowDifferences(a, 40, 20, b, 12, 21, {11, 7}, costs);
  for (int i = 0; i < 53; ++i) {
    const auto difference = [&](int k) {
      return b.at(12 + i + k % 11 - 5, 21 + k / 11 - 3) - a.at(40 + k % 11 - 5, 20 + k / 11 - 3);
    };
    int brighter = 0, sum = 0;
    for (int k = 0; k < 77; ++k) brighter += difference(k);
    const int offset = (brighter * (32768 / 77) + 16384) >> 15;  // rounded
    for (int k = 0; k < 77; ++k) sum += std::abs(difference(k) - offset);
    EXPECT_EQ(costs[i], sum);
  }
}

}  // namespace
}  // namespace motorcade
