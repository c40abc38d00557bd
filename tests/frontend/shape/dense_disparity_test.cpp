#include "frontend/shape/dense_disparity.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

constexpr int kWidth = 160, kHeight = 60;
constexpr double kBehind_px = 4, kBefore_px = 12.5;

bool isBefore(double u, double v) { return u >= 60 && u < 110 && v >= 15 && v < 45; }

/// A textured rectangle before a textured wall.
Image leftImage() {
  const test::Texture wall(1), front(2);
  return test::render(kWidth, kHeight, [&](double u, double v) { return isBefore(u, v) ? front(u, v) : wall(u, v); });
}
Image rightImage() {
  const test::Texture wall(1), front(2);
  return test::render(kWidth, kHeight, [&](double u, double v) {
    return isBefore(u + kBefore_px, v) ? front(u + kBefore_px, v) : wall(u + kBehind_px, v);
  });
}

TEST(DenseDisparity, TellsARectangleFromTheWallBehindIt) {
  DenseDisparity dense;
  const DisparityMap map = dense(leftImage(), rightImage(), {40, 5, 100, 50}, {0, 24});
  ASSERT_EQ(map.window.area(), 5000);
  int known = 0, right = 0;
  for (int row = 0; row < map.window.height; ++row)
    for (int column = 0; column < map.window.width; ++column) {
      const float d = map.at(column, row);
      if (d == DisparityMap::kNone) continue;
      ++known;
      const double truth_px = isBefore(40 + column, 5 + row) ? kBefore_px : kBehind_px;
      right += std::abs(d - truth_px) < 0.6;
    }
  EXPECT_GT(known, 4000);
  EXPECT_GT(right, 0.93 * known);
}

TEST(DenseDisparity, KnowsNothingWhereThereIsNoTextureOrNoCounterpart) {
  DenseDisparity dense;
  const Image plain = test::render(kWidth, kHeight, [](double, double) { return 90.0; });
  for (const float d : dense(plain, plain, {40, 5, 60, 40}, {0, 16}).disparity_px) EXPECT_EQ(d, DisparityMap::kNone);
  // Just left of the rectangle, the right camera sees the rectangle.
  const DisparityMap map = dense(leftImage(), rightImage(), {40, 5, 100, 50}, {0, 24});
  int hidden_known = 0;
  for (int row = 15; row < 35; ++row)
    for (int column = 13; column < 17; ++column) hidden_known += map.at(column, row) != DisparityMap::kNone;
  EXPECT_LT(hidden_known, 50);  // of 80
}

TEST(DenseDisparity, AreMoreExactInTheImagesOfTwiceTheSize) {
  // What is seen here at half size: the wall's disparity is 2.3 there.
  constexpr double kTrue_px = 4.6;
  const test::Texture wall(1);
  const auto seen = [&](double shift_px, int scale) {
    return test::render(kWidth * 2 / scale, kHeight * 2 / scale, [&, shift_px, scale](double u, double v) {
      return wall(scale * (u + 0.5) - 0.5 + shift_px, scale * (v + 0.5) - 0.5);
    });
  };
  DenseDisparity dense;
  DisparityMap map = dense(seen(0, 2), seen(kTrue_px, 2), {40, 5, 100, 50}, {0, 12});
  const auto meanError = [&] {
    double sum_px = 0;
    int known = 0;
    for (const float d : map.disparity_px)
      if (d != DisparityMap::kNone) sum_px += std::abs(d - kTrue_px / 2), ++known;
    EXPECT_GT(known, 4000);
    return sum_px / known;
  };
  const double before_px = meanError();
  refineDisparities(seen(0, 1), seen(kTrue_px, 1), 2, map);
  EXPECT_LT(meanError(), 0.6 * before_px);
  EXPECT_LT(meanError(), 0.06);
}

TEST(DenseDisparity, DoesNotDependOnCallsBefore) {
  DenseDisparity used, fresh;
  used(leftImage(), rightImage(), {0, 0, 150, 60}, {2, 30});
  EXPECT_EQ(used(leftImage(), rightImage(), {40, 5, 50, 40}, {0, 20}).disparity_px,
            fresh(leftImage(), rightImage(), {40, 5, 50, 40}, {0, 20}).disparity_px);
}

TEST(DenseDisparity, CutsWindowAndRangeToWhatThereIs) {
  DenseDisparity dense;
  const DisparityMap map = dense(leftImage(), rightImage(), {-20, -5, 60, 500}, {-3, 20});
  EXPECT_EQ(map.window.u0, 0);
  EXPECT_EQ(map.window.width, 40);
  EXPECT_EQ(map.window.height, kHeight);
  EXPECT_TRUE(dense(leftImage(), rightImage(), {kWidth + 5, 0, 20, 20}, {0, 8}).window.empty());
  EXPECT_TRUE(dense(leftImage(), rightImage(), {0, 0, 20, 20}, {-9, 8}).window.empty());
}

}  // namespace
}  // namespace motorcade
