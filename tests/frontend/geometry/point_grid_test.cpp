#include "frontend/geometry/point_grid.hpp"

#include <random>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

constexpr int kWidth = 300, kHeight = 130;
const auto kItself = [](const Eigen::Vector2f& p_px) { return p_px; };

/// Points in the image and up to `beyond_px` outside of it.
std::vector<Eigen::Vector2f> randomPoints(int count, float beyond_px, std::mt19937& random) {
  std::uniform_real_distribution<float> u(-beyond_px, kWidth + beyond_px), v(-beyond_px, kHeight + beyond_px);
  std::vector<Eigen::Vector2f> points;
  for (int i = 0; i < count; ++i) points.emplace_back(u(random), v(random));
  return points;
}

Eigen::Vector2f ontoImage(const Eigen::Vector2f& p_px) {
  return p_px.cwiseMax(Eigen::Vector2f::Zero()).cwiseMin(Eigen::Vector2f(kWidth, kHeight));
}

bool contains(const Eigen::Vector2f& min_px, const Eigen::Vector2f& max_px, const Eigen::Vector2f& p_px) {
  return (p_px.array() >= min_px.array()).all() && (p_px.array() <= max_px.array()).all();
}

TEST(PointGrid, GivesEveryPointOfARectangleOnceAndNoneFarOutside) {
  std::mt19937 random(1);
  for (const int count : {0, 1, 40, 400}) {
    const auto points = randomPoints(count, 50, random);
    const PointGrid grid(points, kWidth, kHeight, kItself);
    for (int rectangle = 0; rectangle < 100; ++rectangle) {
      const auto corners = randomPoints(2, 50, random);
      const Eigen::Vector2f min_px = corners[0].cwiseMin(corners[1]), max_px = corners[0].cwiseMax(corners[1]);
      std::vector<int> times(points.size(), 0);
      grid.forEachNear(min_px, max_px, [&](int i) { ++times.at(i); });
      const Eigen::Vector2f first = ontoImage(min_px), last = ontoImage(max_px);
      const Eigen::Vector2f cell = Eigen::Vector2f::Constant(PointGrid::kCell_px);
      for (int i = 0; i < count; ++i) {
        const Eigen::Vector2f p_px = ontoImage(points[i]);
        ASSERT_LE(times[i], 1);
        if (contains(first, last, p_px)) {
          ASSERT_EQ(times[i], 1) << p_px.transpose();
        } else if (!contains(first - cell, last + cell, p_px)) {
          ASSERT_EQ(times[i], 0) << p_px.transpose();
        }
      }
    }
  }
}

TEST(PointGrid, ItsExtentReachesAllPointsFromAnyPosition) {
  std::mt19937 random(2);
  const auto points = randomPoints(200, 0, random);
  const PointGrid grid(points, kWidth, kHeight, kItself);
  for (const Eigen::Vector2f& center : randomPoints(50, 0, random)) {
    const Eigen::Vector2f reach = Eigen::Vector2f::Constant(grid.extent_px());
    for (const Eigen::Vector2f& p_px : points) EXPECT_TRUE(contains(center - reach, center + reach, p_px));
    int found = 0;
    grid.forEachNear(center - reach, center + reach, [&](int) { ++found; });
    EXPECT_EQ(found, 200);
  }
}

TEST(PointGrid, TakesPositionsFromItemsOfAnyKind) {
  struct Item {
    float u_px, v_px;
  };
  const std::vector<Item> items{{10, 10}, {200, 100}, {12, 9}};
  const PointGrid grid(items, kWidth, kHeight, [](const Item& item) { return Eigen::Vector2f(item.u_px, item.v_px); });
  std::vector<int> near;
  grid.forEachNear({5, 5}, {15, 15}, [&](int i) { near.push_back(i); });
  EXPECT_EQ(near, (std::vector<int>{0, 2}));  // points of a cell come in their order
}

}  // namespace
}  // namespace motorcade
