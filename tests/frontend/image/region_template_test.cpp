#include "frontend/image/region_template.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

constexpr int kRegionWidth_px = 120, kRegionHeight_px = 90;
const Eigen::Vector2d kRegionMiddle_px(60.3, 44.6);  // where the region is when the template is made
const test::Texture kRegionTexture(71, 8, 40);
constexpr double kPeakError_px = 0.1;  // of a quadratic in place of the correlation's peak

/// Every other pixel of a figure like a person's head and trunk.
std::vector<Eigen::Vector2f> figure() {
  std::vector<Eigen::Vector2f> offsets_px;
  for (int v = -20; v <= 20; v += 2)
    for (int u = -12; u <= 12; u += 2)
      if (v > -10 || std::abs(u) <= 6) offsets_px.emplace_back(u, v);
  return offsets_px;
}

/// The texture with the region's content moved to `middle_px`, `scale` times as large.
Image shownAt(const Eigen::Vector2d& middle_px, double scale = 1, const test::Exposure& exposure = {}) {
  const auto gray = [&](double x, double y) {
    return kRegionTexture(kRegionMiddle_px.x() + (x - middle_px.x()) / scale,
                          kRegionMiddle_px.y() + (y - middle_px.y()) / scale);
  };
  return test::render(kRegionWidth_px, kRegionHeight_px, gray, exposure);
}

RegionTemplate templateOf(const Image& image) { return {image, kRegionMiddle_px, figure()}; }

TEST(RegionTemplate, FindsARegionBetweenPixelsAndLargerOrSmaller) {
  const RegionTemplate region = templateOf(shownAt(kRegionMiddle_px));
  for (const double scale : {0.8, 1.0, 1.3}) {
    for (const double part_px : {0.0, 0.25, 0.5, 0.7}) {
      const Eigen::Vector2d middle_px = kRegionMiddle_px + Eigen::Vector2d(3 + part_px, -2 - part_px);
      const auto match =
          region.find(shownAt(middle_px, scale, {.gain = 0.8, .bias = 12}), kRegionMiddle_px, scale, {7, 6});
      ASSERT_TRUE(match) << scale << " " << part_px;
      EXPECT_GT(match->ncc, 0.95);
      EXPECT_LT((match->middle_px - middle_px).norm(), kPeakError_px) << scale << " " << part_px;
    }
  }
}

TEST(RegionTemplate, IsMadeOfARegionSeenLargerThanItsOffsetsTell) {
  constexpr double kScale = 1.25;
  const Eigen::Vector2d middle_px(57.8, 47.1);
  const RegionTemplate region(shownAt(middle_px, kScale), middle_px, figure(), kScale);
  const auto match = region.find(shownAt(kRegionMiddle_px), {62, 43}, 1, {5, 5});
  ASSERT_TRUE(match);
  EXPECT_LT((match->middle_px - kRegionMiddle_px).norm(), kPeakError_px);
}

TEST(RegionTemplate, AFrozenImageHasAStandardDeviation) {
  const Image image = shownAt(kRegionMiddle_px);
  const auto match = templateOf(image).find(image, kRegionMiddle_px, 1, {5, 5});
  ASSERT_TRUE(match);
  EXPECT_LT((match->middle_px - kRegionMiddle_px).norm(), 0.05);
  EXPECT_GT(match->sigma_px.minCoeff(), 0.01);  // not where it is no number either
}

TEST(RegionTemplate, ItsStandardDeviationsHold) {
  constexpr int kDraws = 100;
  constexpr double kNoise_gray = 12;  // half of the texture's deviation: most of the error is of noise
  const Eigen::Vector2d middle_px = kRegionMiddle_px + Eigen::Vector2d(1.4, -0.8);
  const Image before = shownAt(kRegionMiddle_px), now = shownAt(middle_px);
  const auto noisy = [](const Image& image, unsigned seed) {
    const auto gray = [&](double x, double y) { return image.at(static_cast<int>(x), static_cast<int>(y)); };
    return test::render(kRegionWidth_px, kRegionHeight_px, gray, {.noise = kNoise_gray, .seed = seed});
  };
  int within = 0;
  double squared = 0;
  for (unsigned draw = 0; draw < kDraws; ++draw) {
    const RegionTemplate region = templateOf(noisy(before, 2 * draw + 1));
    const auto match = region.find(noisy(now, 2 * draw + 2), kRegionMiddle_px, 1, {4, 4});
    ASSERT_TRUE(match) << draw;
    const Eigen::Array2d errors = (match->middle_px - middle_px).array() / match->sigma_px.array();
    within += (errors.abs() < 3).all();
    squared += errors.square().mean() / kDraws;
  }
  EXPECT_GE(within, 0.95 * kDraws);
  EXPECT_LT(squared, 1.5);
  EXPECT_GT(squared, 0.02);  // pixels count as fewer than there are: cautious by 7 at most
}

TEST(RegionTemplate, ARadiusOfZeroLeavesItsCoordinateAsGuessed) {
  const RegionTemplate region = templateOf(shownAt(kRegionMiddle_px));
  const Eigen::Vector2d middle_px = kRegionMiddle_px + Eigen::Vector2d(2.4, 0.3);
  const Image image = shownAt(middle_px);
  const auto in_row = region.find(image, kRegionMiddle_px, 1, {5, 0});
  ASSERT_TRUE(in_row);
  EXPECT_EQ(in_row->middle_px.y(), kRegionMiddle_px.y());
  EXPECT_NEAR(in_row->middle_px.x(), middle_px.x(), 0.2);  // 0.3 px beside the row, where waves are oblique
  const auto in_column = region.find(image, {middle_px.x() + 0.1, middle_px.y() + 1.6}, 1, {0, 4});
  ASSERT_TRUE(in_column);
  EXPECT_EQ(in_column->middle_px.x(), middle_px.x() + 0.1);
  EXPECT_NEAR(in_column->middle_px.y(), middle_px.y(), 0.1);
}

TEST(RegionTemplate, FindsNothingWhereThePeakIsAtTheWindowsEdge) {
  const RegionTemplate region = templateOf(shownAt(kRegionMiddle_px));
  const auto isFound = [&](double right_px, double down_px) {
    const Image image = shownAt(kRegionMiddle_px + Eigen::Vector2d(right_px, down_px));
    return region.find(image, kRegionMiddle_px, 1, {5, 4}).has_value();
  };
  EXPECT_TRUE(isFound(4, 3));
  EXPECT_TRUE(isFound(-4, -3));
  for (const double aside_px : {-5.0, 5.0}) EXPECT_FALSE(isFound(aside_px, 0)) << aside_px;
  for (const double down_px : {-4.0, 4.0}) EXPECT_FALSE(isFound(0, down_px)) << down_px;
  EXPECT_FALSE(isFound(5.6, 0)) << "beyond the window, at whose edge it correlates most";
}

TEST(RegionTemplate, FindsNothingWhereTheTextureRepeats) {
  constexpr double kPeriod_px = 12;
  const auto fence = [](double x, double y) {
    return 128 + 40 * std::sin(2 * std::numbers::pi * x / kPeriod_px) + 20 * std::sin(0.5 * y);
  };
  const auto seen = [&](unsigned seed) {
    return test::render(kRegionWidth_px, kRegionHeight_px, fence, {.noise = 3, .seed = seed});
  };
  const RegionTemplate region = templateOf(seen(1));
  const Eigen::Vector2d between_two_px = kRegionMiddle_px - Eigen::Vector2d(kPeriod_px / 2, 0);
  for (unsigned seed = 2; seed < 12; ++seed) {
    EXPECT_TRUE(region.find(seen(seed), kRegionMiddle_px, 1, {5, 4})) << "one period alone is in the window";
    EXPECT_FALSE(region.find(seen(seed), between_two_px, 1, {10, 4})) << seed;
  }
}

TEST(RegionTemplate, FindsNothingWhereItsRegionOrTheImageIsUniform) {
  const Image textured = shownAt(kRegionMiddle_px),
              uniform = test::render(kRegionWidth_px, kRegionHeight_px, [](double, double) { return 90.0; });
  EXPECT_FALSE(templateOf(uniform).find(textured, kRegionMiddle_px, 1, {5, 4}));
  EXPECT_FALSE(templateOf(uniform).find(uniform, kRegionMiddle_px, 1, {5, 4}));
  EXPECT_FALSE(templateOf(textured).find(uniform, kRegionMiddle_px, 1, {5, 4}));
  EXPECT_FALSE(RegionTemplate(textured, kRegionMiddle_px, {}).find(textured, kRegionMiddle_px, 1, {5, 4}));
}

TEST(RegionTemplate, FindsNothingInAnotherScene) {
  const RegionTemplate region = templateOf(shownAt(kRegionMiddle_px));
  int found = 0;
  constexpr int kScenes = 20;
  for (unsigned seed = 0; seed < kScenes; ++seed) {
    const Image other = test::render(kRegionWidth_px, kRegionHeight_px, test::Texture(200 + seed, 8, 40));
    const auto match = region.find(other, kRegionMiddle_px, 1, {7, 6});
    found += match && match->ncc > 0.7;
  }
  EXPECT_EQ(found, 0);
}

TEST(RegionTemplate, ReadsNothingOutsideTheImage) {  // for the sanitizers; the border is repeated
  const Image image = test::render(33, 20, test::Texture(16));
  for (const double u : {-40.0, 0.0, 16.4, 32.0, 70.0})
    for (const double v : {-30.0, 0.0, 9.7, 19.0, 50.0})
      RegionTemplate(image, {u, v}, figure(), 1.5).find(image, {u, v}, 2, {5, 5});
}

}  // namespace
}  // namespace motorcade
