#include "frontend/motion/window_correlation.hpp"

#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

constexpr int kSide = WindowPattern::kSide, kWidth = 40, kHeight = 24;

/// Image of independent gray levels in a range.
Image noise(unsigned seed, ImagePool& pool, int least = 60, int most = 200) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> gray(least, most);
  Image image = pool.acquire(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) image.mutableRow(y)[x] = static_cast<std::uint8_t>(gray(random));
  return image;
}

/// Normalized cross-correlation of the windows that begin at these pixels.
double correlationOf(const Image& a, int ax, int ay, const Image& b, int bx, int by) {
  const auto mean = [](const Image& image, int x, int y) {
    double sum = 0;
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i) sum += image.row(y + j)[x + i];
    return sum / (kSide * kSide);
  };
  const double mean_a = mean(a, ax, ay), mean_b = mean(b, bx, by);
  double ab = 0, aa = 0, bb = 0;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      const double p = a.row(ay + j)[ax + i] - mean_a, q = b.row(by + j)[bx + i] - mean_b;
      ab += p * q, aa += p * p, bb += q * q;
    }
  return ab / std::sqrt(aa * bb);
}

/// The middle of the window that begins at a pixel.
Eigen::Vector2f middleOf(int x, int y) { return Eigen::Vector2f(x, y).array() + 0.5F * (kSide - 1); }

TEST(WindowCorrelation, IsTheNormalizedCrossCorrelationOfBothWindows) {
  ImagePool pool;
  const Image then = noise(1, pool), now = noise(2, pool);
  const CorrelatedImage correlated(now);
  const auto pattern = WindowPattern::sample(then, middleOf(5, 7), 1);
  ASSERT_TRUE(pattern);
  constexpr double kRounding = 1e-3;  // of 64 values to a 2048th of the window's norm
  for (const auto& [x, y] : std::array<std::array<int, 2>, 4>{{{0, 0}, {5, 7}, {11, 3}, {32, 16}}})
    EXPECT_NEAR(correlated.correlation(*pattern, middleOf(x, y)).value_or(9), correlationOf(then, 5, 7, now, x, y),
                kRounding)
        << x << ", " << y;
  EXPECT_NEAR(CorrelatedImage(then).correlation(*pattern, middleOf(5, 7)).value_or(9), 1, kRounding);
}

/// A pattern's rounded values do not sum up to zero, which a bright window without contrast would make large.
TEST(WindowCorrelation, HoldsForBrightWindowsWithLittleContrast) {
  ImagePool pool;
  const Image then = noise(6, pool, 240, 250), now = noise(7, pool, 240, 250);
  const CorrelatedImage correlated(now);
  for (int x = 0; x < kWidth - kSide; ++x) {
    const auto pattern = WindowPattern::sample(then, middleOf(x, 3), 1);
    ASSERT_TRUE(pattern);
    EXPECT_NEAR(correlated.correlation(*pattern, middleOf(x, 9)).value_or(9), correlationOf(then, x, 3, now, x, 9),
                1e-3);
  }
}

TEST(WindowCorrelation, APatternMayBeSeenFromNearer) {
  ImagePool pool;
  const Image far = noise(3, pool);
  Image near = pool.acquire(2 * kWidth, 2 * kHeight);
  for (int y = 0; y < 2 * kHeight; ++y)
    for (int x = 0; x < 2 * kWidth; ++x) near.mutableRow(y)[x] = far.row(y / 2)[x / 2];
  const auto pattern = WindowPattern::sample(far, {12.5F, 9.5F}, 2);  // whose corners are those of four pixels
  ASSERT_TRUE(pattern);
  EXPECT_GT(CorrelatedImage(near).correlation(*pattern, {25.5F, 19.5F}).value_or(0), 0.99F);
}

TEST(WindowCorrelation, ThereIsNoneBeyondTheBorderAndNothingToSeeWithoutTexture) {
  ImagePool pool;
  const Image image = noise(4, pool), uniform = noise(5, pool, 128, 128);
  EXPECT_FALSE(WindowPattern::sample(image, middleOf(-1, 3), 1));
  EXPECT_FALSE(WindowPattern::sample(image, middleOf(kWidth - kSide + 1, 3), 1));
  EXPECT_FALSE(WindowPattern::sample(uniform, middleOf(5, 5), 1));
  const auto pattern = WindowPattern::sample(image, middleOf(5, 5), 1);
  ASSERT_TRUE(pattern);
  const CorrelatedImage correlated(image);
  for (const auto& at_px : {middleOf(-1, 3), middleOf(3, -1), middleOf(kWidth - kSide + 1, 3),
                            middleOf(3, kHeight - kSide + 1), Eigen::Vector2f(NAN, NAN)})
    EXPECT_FALSE(correlated.correlation(*pattern, at_px)) << at_px.transpose();
  EXPECT_EQ(CorrelatedImage(uniform).correlation(*pattern, middleOf(5, 5)), 0.0F);
  const Image tiny = pool.acquire(kSide - 1, kSide - 1);
  EXPECT_FALSE(CorrelatedImage(tiny).correlation(*pattern, middleOf(0, 0)));
}

}  // namespace
}  // namespace motorcade
