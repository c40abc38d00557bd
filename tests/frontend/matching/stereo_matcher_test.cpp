#include "frontend/matching/stereo_matcher.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "frontend/features/feature_preparation.hpp"
#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

/// A fronto-parallel wall at each disparity: the image's columns are split into panels of different depth.
constexpr int kPanel_px = 100;
double disparityAt(double u_px) { return 3.4 + 11.37 * std::floor(u_px / kPanel_px); }

StereoFramePtr panels() {
  const test::Texture texture(41);
  const auto left = [&](double x, double y) { return texture(x, y); };
  // The nearest panel that maps to a right pixel hides the others.
  const auto right = [&](double x, double y) {
    for (int panel = 3; panel >= 0; --panel) {
      const double u = x + disparityAt(panel * kPanel_px);
      if (u >= panel * kPanel_px && u < (panel + 1) * kPanel_px) return texture(u, y);
    }
    return texture(x + 1000, y);  // what only the right image shows
  };
  return test::stereoFrame(0, test::render(400, 200, left, {.noise = 1}),
                           test::render(400, 200, right, {.gain = 0.9, .bias = 10, .noise = 1, .seed = 2}));
}

/// Farther than the window from a panel's edge, and visible in both images.
bool isClear(const Corner& corner) {
  const double in_panel = std::fmod(corner.u_px, kPanel_px);
  return in_panel > 12 && in_panel < kPanel_px - 24 && corner.u_px - disparityAt(corner.u_px) > 10;
}

TEST(StereoMatcher, FindsTheDisparityOfEachPanel) {
  const auto features = FeaturePreparation({})(panels());
  const auto matches = StereoMatcher({})(features);
  ASSERT_EQ(matches->of_corner.size(), features->corners.size());
  int clear = 0, matched = 0;
  double squares = 0;
  for (std::size_t i = 0; i < features->corners.size(); ++i) {
    const Corner& corner = features->corners[i];
    if (!isClear(corner)) continue;
    ++clear;
    const auto match = refinedMatch(*matches, i);
    if (!match) continue;
    ++matched;
    const double error_px = match->disparity_px - disparityAt(corner.u_px);
    EXPECT_LT(std::abs(error_px), 0.5);
    squares += error_px * error_px;
  }
  EXPECT_GE(clear, 100);
  EXPECT_GE(matched, 0.9 * clear);
  EXPECT_LT(std::sqrt(squares / matched), 0.1);
}

TEST(StereoMatcher, RejectsAmbiguousTexture) {
  const auto fence = [](double x, double y) { return 128 + 50 * std::sin(x * 0.7) * std::sin(y * 0.4); };
  const auto features = FeaturePreparation({})(test::stereoFrame(
      0, test::render(400, 200, fence, {.noise = 1}), test::render(400, 200, fence, {.noise = 1, .seed = 2})));
  ASSERT_GE(features->corners.size(), 50U);
  const auto matches = StereoMatcher({})(features);
  int matched = 0;
  for (std::size_t i = 0; i < features->corners.size(); ++i) matched += refinedMatch(*matches, i).has_value();
  EXPECT_LE(matched, static_cast<int>(features->corners.size()) / 20);
}

TEST(StereoMatcher, GivesNoMatchesForARejectedFrame) {
  const auto matches = StereoMatcher({})(FeaturePreparation({})(test::rejectedFrame(0)));
  EXPECT_TRUE(matches->of_corner.empty());
}

}  // namespace
}  // namespace motorcade
