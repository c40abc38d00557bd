#include "apps/draw/canvas.hpp"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

int differingPixels(const Canvas& a, const Canvas& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.image().pixels.size(); i += 3) count += a.image().pixels[i] != b.image().pixels[i];
  return count;
}

TEST(Canvas, ALineCoversItsWidthTimesItsLength) {
  const Canvas empty(60, 40, {0, 0, 0});
  Canvas canvas = empty;
  canvas.line({10, 20}, {50, 20}, {200, 0, 0}, 3);
  double sum = 0;
  for (std::size_t i = 0; i < canvas.image().pixels.size(); i += 3) sum += canvas.image().pixels[i] / 200.0;
  EXPECT_NEAR(sum, 3 * 40 + 7, 4) << "with its two round ends";
}

TEST(Canvas, APolygonCoversItsAreaWhicheverWayItTurns) {
  for (const bool turned : {false, true}) {
    Canvas canvas(60, 40, {0, 0, 0});
    std::vector<Eigen::Vector2d> corners{{10, 10}, {40, 10}, {40, 30}, {10, 30}};
    if (turned) std::reverse(corners.begin(), corners.end());
    canvas.fillPolygon(corners, {200, 0, 0});
    double sum = 0;
    for (std::size_t i = 0; i < canvas.image().pixels.size(); i += 3) sum += canvas.image().pixels[i] / 200.0;
    EXPECT_NEAR(sum, 30 * 20, 5);  // anti-aliasing takes a little off the corners
  }
}

TEST(Canvas, ShapesOutsideOrWithoutAPlaceAreCut) {
  const Canvas empty(30, 20, {9, 9, 9});
  Canvas canvas = empty;
  const double none = std::numeric_limits<double>::quiet_NaN();
  canvas.line({-100, -100}, {-5, -90}, {255, 0, 0}, 3);
  canvas.line({none, 0}, {5, 5}, {255, 0, 0}, 3);
  canvas.fillPolygon({{100, 100}, {120, 100}, {110, 130}}, {255, 0, 0});
  canvas.text({-200, 5}, "off", {255, 0, 0});
  canvas.text({1e9, 5}, "off", {255, 0, 0});
  EXPECT_EQ(differingPixels(canvas, empty), 0);
  canvas.line({-1e9, 10}, {1e9, 10}, {255, 0, 0}, 1);
  EXPECT_GE(differingPixels(canvas, empty), 30);
}

TEST(Canvas, EveryLetterOfTheLabelsHasAShape) {
  const Canvas empty(30, 30, {0, 0, 0});
  for (const char letter : std::string_view("0123456789#./-:abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ")) {
    Canvas canvas = empty;
    canvas.text({2, 2}, std::string_view(&letter, 1), {255, 255, 255});
    EXPECT_GT(differingPixels(canvas, empty), 0) << letter;
  }
}

}  // namespace
}  // namespace motorcade
