#include "apps/evaluate/comparison/overlap.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

TEST(OverlapArea, OfTurnedSquares) {
  const Footprint square{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  Footprint turned;
  for (const Eigen::Vector2d& p : square)
    turned.emplace_back((p.x() - p.y()) / std::sqrt(2), (p.x() + p.y()) / std::sqrt(2));
  EXPECT_NEAR(areaOf(turned), 4, 1e-12);
  EXPECT_NEAR(overlapArea(square, turned), 8 * (std::sqrt(2) - 1), 1e-9);  // a regular octagon
  Footprint far = square;
  for (Eigen::Vector2d& p : far) p.x() += 5;
  EXPECT_EQ(overlapArea(square, far), 0);
}

TEST(IntersectionOverUnion, OfBoxes) {
  EXPECT_NEAR(intersectionOverUnion({0, 0, 10, 10}, {5, 0, 15, 10}), 1.0 / 3, 1e-12);
  EXPECT_EQ(intersectionOverUnion({0, 0, 10, 10}, {20, 0, 30, 10}), 0);
  EXPECT_EQ(intersectionOverUnion({0, 0, 0, 0}, {0, 0, 0, 0}), 0);
}

}  // namespace
}  // namespace motorcade
