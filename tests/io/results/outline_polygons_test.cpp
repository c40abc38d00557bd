#include "io/results/outline_polygons.hpp"

#include <cmath>

#include <gmock/gmock.h>

namespace motorcade {
namespace {

template <class Inside>
ObjectMask maskWhere(int width, int height, int cell_px, const Inside& inside) {
  ObjectMask mask{
      .track = {3}, .left_px = 100, .top_px = 40, .cell_px = cell_px, .width = width, .height = height, .inside = {}};
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) mask.inside.push_back(inside(column, row) ? 1 : 0);
  return mask;
}

double areaOf(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2i &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return std::abs(twice) / 2;
}

constexpr int kWidth_px = 640, kHeight_px = 200;

TEST(OutlinePolygons, ARectangleHasItsFourCornersAtItsOuterPixels) {
  const auto polygons =
      outlinePolygons(maskWhere(10, 6, 4, [](int u, int v) { return u >= 2 && v >= 1; }), kWidth_px, kHeight_px);
  ASSERT_EQ(polygons.size(), 1U);
  EXPECT_THAT(polygons[0], testing::UnorderedElementsAre(Eigen::Vector2i(108, 44), Eigen::Vector2i(139, 44),
                                                         Eigen::Vector2i(139, 63), Eigen::Vector2i(108, 63)));
}

TEST(OutlinePolygons, StairsOfADiscBecomeARoundPolygonOfTheSameArea) {
  constexpr double kRadius = 20;  // cells
  const auto polygons = outlinePolygons(
      maskWhere(50, 50, 2, [](int u, int v) { return std::hypot(u - 25, v - 25) < kRadius; }), kWidth_px, kHeight_px);
  ASSERT_EQ(polygons.size(), 1U);
  EXPECT_LT(polygons[0].size(), 40U) << "the border has 160 cells";
  EXPECT_NEAR(areaOf(polygons[0]) / (M_PI * 4 * kRadius * kRadius), 1, 0.05);
}

TEST(OutlinePolygons, PiecesComeLargestFirstAndEndAtTheImage) {
  const auto polygons = outlinePolygons(
      maskWhere(300, 8, 2, [](int u, int) { return u < 3 || (u > 5 && u < 40) || u > 260; }), kWidth_px, kHeight_px);
  ASSERT_EQ(polygons.size(), 3U);
  EXPECT_GT(areaOf(polygons[0]), areaOf(polygons[1]));
  int right_px = 0;
  for (const auto& polygon : polygons)
    for (const auto& corner : polygon) right_px = std::max(right_px, corner.x());
  EXPECT_EQ(right_px, kWidth_px - 1);
}

TEST(OutlinePolygons, ALineIsJson) {
  EXPECT_EQ(outlineLine({12}, {3}, {{{1, 2}, {3, 4}, {5, 6}}, {{7, 8}, {9, 0}, {1, 1}}}),
            R"({"frame":12,"track_id":3,"polygons":[[[1,2],[3,4],[5,6]],[[7,8],[9,0],[1,1]]]})");
  EXPECT_TRUE(outlinePolygons(maskWhere(4, 4, 2, [](int, int) { return false; }), kWidth_px, kHeight_px).empty());
}

}  // namespace
}  // namespace motorcade
