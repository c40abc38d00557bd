#include "frontend/matching/neighbor_shifts.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

constexpr int kNeighborsWidth_px = 400, kNeighborsHeight_px = 160;

/// Points at whole pixels, so that equal distances occur.
std::vector<MovedPoint> randomPoints(int count, float spread, std::mt19937& random) {
  std::uniform_real_distribution<float> unit(0, 1), shift(-20, 20);
  std::vector<MovedPoint> points;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2f from_px(std::round(spread * kNeighborsWidth_px * unit(random)),
                                  std::round(spread * kNeighborsHeight_px * unit(random)));
    points.push_back({from_px, {shift(random), shift(random)}});
  }
  return points;
}

float middleOf(std::array<float, 3> values) {
  std::ranges::sort(values);
  return values[1];
}

Shift medianByBruteForce(std::vector<MovedPoint> points, const Eigen::Vector2f& from_px) {
  std::ranges::stable_sort(points, {}, [&](const MovedPoint& p) { return (p.from_px - from_px).squaredNorm(); });
  const Shift &a = points[0].shift, &b = points[1].shift, &c = points[2].shift;
  return {middleOf({a.du_px, b.du_px, c.du_px}), middleOf({a.dv_px, b.dv_px, c.dv_px})};
}

TEST(NeighborShifts, AreTheMedianOfTheThreeNearestOfAllPoints) {
  std::mt19937 random(4);
  for (const float spread : {1.0F, 0.2F}) {  // all over the image, or in a corner, far from most positions
    for (const int count : {3, 10, 300}) {
      const auto points = randomPoints(count, spread, random);
      const NeighborShifts shifts(points, kNeighborsWidth_px, kNeighborsHeight_px);
      for (const MovedPoint& query : randomPoints(100, 1, random)) {
        const auto median = shifts.medianAround(query.from_px);
        const Shift expected = medianByBruteForce(points, query.from_px);
        ASSERT_TRUE(median);
        EXPECT_EQ(median->du_px, expected.du_px) << query.from_px.transpose();
        EXPECT_EQ(median->dv_px, expected.dv_px) << query.from_px.transpose();
      }
    }
  }
}

TEST(NeighborShifts, AreUnknownBelowThreePoints) {
  std::mt19937 random(5);
  for (int count = 0; count < 3; ++count)
    EXPECT_FALSE(
        NeighborShifts(randomPoints(count, 1, random), kNeighborsWidth_px, kNeighborsHeight_px).medianAround({50, 50}));
}

}  // namespace
}  // namespace motorcade
