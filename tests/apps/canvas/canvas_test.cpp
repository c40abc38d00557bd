#include "apps/canvas/canvas.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

using Eigen::Vector2d;

constexpr Pen kRed{.color = {200, 0, 0}, .width_px = 3};
constexpr TextStyle kWhite{.color = {255, 255, 255}, .size_px = 14};

int differingPixels(const Canvas& a, const Canvas& b) {
  const RgbImage one = a.image(), other = b.image();
  int count = 0;
  for (std::size_t i = 0; i < one.pixels.size(); i += 3) count += one.pixels[i] != other.pixels[i];
  return count;
}

/// Number of pixels that a drawing in red covers, those at its rim in part.
double coveredByRed(const Canvas& canvas) {
  double sum = 0;
  const RgbImage image = canvas.image();
  for (std::size_t i = 0; i < image.pixels.size(); i += 3) sum += image.pixels[i] / 200.0;
  return sum;
}

TEST(Canvas, ALineCoversItsWidthTimesItsLength) {
  Canvas canvas(60, 40, {0, 0, 0});
  canvas.line({10, 20}, {50, 20}, kRed);
  EXPECT_NEAR(coveredByRed(canvas), 3 * 40 + 7, 2) << "with its two round ends";
  const RgbImage image = canvas.image();
  EXPECT_EQ(image.at(30, 21)[0], 200) << "whole numbers are pixel centers";
  EXPECT_EQ(image.at(30, 22)[0], 0);
}

TEST(Canvas, ADashedLineCoversItsDashes) {
  Canvas canvas(60, 40, {0, 0, 0});
  Pen pen = kRed;
  pen.dashes_px = {6, 2};
  canvas.line({10, 20}, {50, 20}, pen);
  EXPECT_NEAR(coveredByRed(canvas), 3 * 30, 2);
}

TEST(Canvas, AnAreaIsTranslucentAsAsked) {
  Canvas canvas(60, 40, {0, 0, 0});
  const std::vector<Vector2d> corners{{9.5, 9.5}, {39.5, 9.5}, {39.5, 29.5}, {9.5, 29.5}};
  canvas.fill(corners, {{200, 0, 0}, 0.5});
  EXPECT_NEAR(coveredByRed(canvas), 0.5 * 30 * 20, 5);
  canvas.fillRounded({50, 5, 4, 4}, 2, {{200, 0, 0}, 1});
  EXPECT_NEAR(coveredByRed(canvas), 0.5 * 30 * 20 + 12.6, 5) << "a circle";
}

TEST(Canvas, WhatIsOutsideOrHasNoPlaceIsCut) {
  const Canvas empty(30, 20, {9, 9, 9});
  Canvas canvas(30, 20, {9, 9, 9});
  const double none = std::numeric_limits<double>::quiet_NaN(), endless = std::numeric_limits<double>::infinity();
  canvas.line({-100, -100}, {-5, -90}, kRed);
  canvas.line({none, 0}, {5, 5}, kRed);
  canvas.arrow({5, endless}, {5, 5}, kRed);
  canvas.arrow({5, 5}, {5, 5}, kRed);
  canvas.dot({none, 5}, 3, {});
  canvas.fillRounded({5, 5, none, 5}, 3, {});
  canvas.fill(std::vector<Vector2d>{{1, 1}, {9, 1}, {none, 9}}, {});
  canvas.fill(std::vector<Vector2d>{{100, 100}, {120, 100}, {110, 130}}, {});
  canvas.outline(std::vector<Vector2d>{}, kRed);
  canvas.text({-200, 5}, "off", kWhite);
  canvas.text({none, 5}, "off", kWhite);
  canvas.paste(Image(), {0, 0, 5, 5});
  EXPECT_EQ(differingPixels(canvas, empty), 0);
  canvas.polyline(std::vector<Vector2d>{{2, 2}, {2, 9}, {none, none}, {20, 2}, {20, 9}}, kRed);
  EXPECT_EQ(canvas.image().at(11, 5)[0], 9) << "a way breaks where a point has no place";
  EXPECT_EQ(canvas.image().at(20, 5)[0], 200);
  canvas.line({-1e5, 12}, {1e5, 12}, kRed);
  EXPECT_EQ(canvas.image().at(15, 12)[0], 200);
}

TEST(Canvas, APartDrawsOnTheWholeAndNoFurtherThanItsEdges) {
  Canvas canvas(60, 40, {0, 0, 0});
  Canvas part = canvas.part(20, 10, 20, 20);
  part.line({-50, 5}, {50, 5}, kRed);
  const RgbImage image = canvas.image();
  EXPECT_EQ(image.at(20, 15)[0], 200);
  EXPECT_EQ(image.at(39, 15)[0], 200);
  EXPECT_EQ(image.at(19, 15)[0], 0);
  EXPECT_EQ(image.at(40, 15)[0], 0);
}

TEST(Canvas, EveryLetterOfTheLabelsHasAShape) {
  const Canvas empty(40, 40, {0, 0, 0});
  for (const std::string letter : {"0", "9", "#", "a", "Z", ".", "±", "·", "−", "σ"}) {
    Canvas canvas(40, 40, {0, 0, 0});
    canvas.text({5, 25}, letter, kWhite);
    EXPECT_GT(differingPixels(canvas, empty), 0) << letter;
    EXPECT_GT(Canvas::textWidth(letter, kWhite), 2) << letter;
  }
}

TEST(Canvas, TextThatIsNoUtf8IsStillDrawnAndSoIsWhatFollows) {
  Canvas canvas(80, 40, {0, 0, 0});
  canvas.text({5, 20}, "a\xFF\xC3", kWhite);
  Canvas question_marks(80, 40, {0, 0, 0});
  question_marks.text({5, 20}, "a\?\?", kWhite);
  EXPECT_EQ(differingPixels(canvas, question_marks), 0);
  EXPECT_EQ(Canvas::textWidth("a\xFF", kWhite), Canvas::textWidth("a?", kWhite));
  canvas.line({10, 30}, {70, 30}, kRed);
  EXPECT_EQ(canvas.image().at(40, 30)[0], 200);
}

TEST(Canvas, AGrayImageFillsTheRectangleThatItIsPastedTo) {
  ImagePool pool;
  Image gray = pool.acquire(10, 10);
  for (int y = 0; y < 10; ++y) std::fill_n(gray.mutableRow(y), 10, std::uint8_t{120});
  Canvas canvas(60, 40, {0, 0, 0});
  canvas.paste(gray, {20, 10, 20, 20});
  const RgbImage image = canvas.image();
  for (const auto& [x, y] : {std::pair(20, 10), std::pair(39, 29), std::pair(30, 20)})
    EXPECT_EQ(image.at(x, y)[1], 120) << x << ", " << y;
  EXPECT_EQ(image.at(19, 20)[1], 0);
  EXPECT_EQ(image.at(40, 20)[1], 0);
}

}  // namespace
}  // namespace motorcade
