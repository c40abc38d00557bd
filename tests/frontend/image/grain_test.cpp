#include "frontend/image/grain.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

const test::Texture kSmoothTexture(61, 20, 60);

Image noisy(double sigma_gray) { return test::render(400, 300, kSmoothTexture, {.noise = sigma_gray}); }

double rmsAgainst(const Image& image, const Image& truth) {
  double squares = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) squares += std::pow(image.at(x, y) - truth.at(x, y), 2);
  return std::sqrt(squares / (image.width() * image.height()));
}

/// Mean under the binomial 5x5 window, the border's pixels being repeated.
double binomialMean(const Image& image, int x, int y) {
  constexpr std::array kWeights{1, 4, 6, 4, 1};
  double sum = 0;
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx)
      sum += kWeights[dx + 2] * kWeights[dy + 2] *
             image.at(std::clamp(x + dx, 0, image.width() - 1), std::clamp(y + dy, 0, image.height() - 1));
  return sum / 256;
}

TEST(Grain, IsTheNoiseOfSmoothParts) {
  for (const double sigma : {2.0, 5.0, 10.0, 20.0}) {
    const auto grain = grainOf(noisy(sigma));
    ASSERT_TRUE(grain);
    EXPECT_NEAR(grain->smooth_gray, sigma, 0.15 * sigma);
  }
  EXPECT_LT(grainOf(noisy(0))->smooth_gray, 0.4F);  // rounding to whole grays alone is 0.3
}

/// A dark image of the same scene with as much less noise.
TEST(Grain, IsTheSameShareOfTheContrastInTheDark) {
  constexpr double kExposure = 0.25, kSigma = 16;
  const Image bright = noisy(kSigma);
  const Image dark = test::render(400, 300, [](double u, double v) { return kExposure * kSmoothTexture(u, v); },
                                  {.noise = kExposure * kSigma});
  const auto by_day = grainOf(bright), by_night = grainOf(dark);
  ASSERT_TRUE(by_day && by_night);
  EXPECT_NEAR(by_night->smooth_gray, kExposure * by_day->smooth_gray, 0.5);
  EXPECT_NEAR(by_night->relative_gray / by_day->relative_gray, 1, 0.1);
}

TEST(Grain, IsUnknownWhereTheImageIsClippedOrTiny) {
  EXPECT_FALSE(grainOf(test::render(400, 300, [](double, double) { return 400.0; })));
  EXPECT_FALSE(grainOf(test::render(60, 40, kSmoothTexture)));
}

TEST(Denoised, LeavesImagesWithTheUsualGrainAsTheyAre) {
  ImagePool pool;
  const Image image = noisy(3);
  EXPECT_EQ(denoised(image, *grainOf(image), pool).row(0), image.row(0));  // the same buffer
}

TEST(Denoised, ComesNearerToTheSceneTheMoreThereIsToGain) {
  ImagePool pool;
  const Image truth = noisy(0);
  EXPECT_LT(rmsAgainst(denoised(noisy(10), {.smooth_gray = 10}, pool), truth), 9);
  EXPECT_LT(rmsAgainst(denoised(noisy(20), {.smooth_gray = 20}, pool), truth), 20.0 / 3);
}

TEST(Denoised, CountsRelativeGrainHalf) {
  ImagePool pool;
  const Image image = noisy(3);
  EXPECT_EQ(denoised(image, {.smooth_gray = 3, .relative_gray = 15}, pool).row(0), image.row(0));
  const Image by_relative = denoised(image, {.smooth_gray = 3, .relative_gray = 32}, pool),
              by_smooth = denoised(image, {.smooth_gray = 16}, pool);
  EXPECT_EQ(rmsAgainst(by_relative, by_smooth), 0);
}

TEST(Denoised, IsTheBinomialMeanUpToTheBorder) {
  ImagePool pool;
  const Image image = test::render(37, 23, test::Texture(62), {.noise = 20});
  const Image smooth = denoised(image, {.smooth_gray = 20}, pool);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) ASSERT_NEAR(smooth.at(x, y), binomialMean(image, x, y), 0.51);
}

}  // namespace
}  // namespace motorcade
