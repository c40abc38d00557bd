#include "frontend/shape/path_costs.hpp"

#include <algorithm>
#include <array>
#include <random>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

std::uint8_t& at(DisparityBlocks& blocks, int line, int pixel, int disparity) {
  return blocks.at(
      line, pixel / DisparityBlocks::kBlock)[disparity * DisparityBlocks::kBlock + pixel % DisparityBlocks::kBlock];
}

struct Direction {
  int line, pixel;
};

/// The cost of one disparity at one pixel with the cheapest way there, by recursion.
int costAlong(DisparityBlocks& costs, Direction by, int line, int pixel, int disparity, int left) {
  constexpr int kStep = 5, kJump = 22;
  const int own = at(costs, line, pixel, disparity);
  const int before_line = line - by.line, before_pixel = pixel - by.pixel;
  const bool starts =
      before_line < 0 || before_pixel < 0 || before_line >= costs.lines() || before_pixel >= costs.pixels();
  if (starts || left == 0) return own;
  std::array<int, 3> before{};
  for (int d = 0; d < 3; ++d) before[d] = costAlong(costs, by, before_line, before_pixel, d, left - 1);
  const int least = *std::ranges::min_element(before);
  int way = least + kJump;
  for (int d = 0; d < 3; ++d)
    way = std::min(way, before[d] + (d == disparity ? 0 : std::abs(d - disparity) == 1 ? kStep : kJump));
  return own + way - least;
}

TEST(PathCosts, AreSummedAlongFourDirections) {
  constexpr int kLines = 5, kPixels = 6, kDisparities = 3;
  DisparityBlocks costs, sums;
  costs.resize(kLines, kPixels, kDisparities);
  std::mt19937 random(3);
  for (int line = 0; line < kLines; ++line)
    for (int pixel = 0; pixel < kPixels; ++pixel)
      for (int d = 0; d < kDisparities; ++d)
        at(costs, line, pixel, d) = static_cast<std::uint8_t>(random() % (PathCosts::kMostCost + 1));
  PathCosts path_costs;
  path_costs.sum(costs, sums);
  for (int line = 0; line < kLines; ++line)
    for (int pixel = 0; pixel < kPixels; ++pixel)
      for (int d = 0; d < kDisparities; ++d) {
        int sum = 0;
        for (const Direction by : {Direction{0, 1}, Direction{0, -1}, Direction{1, 0}, Direction{-1, 0}})
          sum += costAlong(costs, by, line, pixel, d, kPixels);
        ASSERT_EQ(at(sums, line, pixel, d), sum) << line << " " << pixel << " " << d;
      }
}

}  // namespace
}  // namespace motorcade
