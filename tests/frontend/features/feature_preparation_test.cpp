#include "frontend/features/feature_preparation.hpp"

#include <algorithm>
#include <cmath>
#include <thread>

#include <gtest/gtest.h>

#include "frontend/image/image_pyramid.hpp"
#include "frontend/matching/stereo_matcher.hpp"
#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

TEST(FeaturePreparation, MakesPyramidsAndCorners) {
  const Image image = test::render(320, 200, test::Texture(51));
  const auto features = FeaturePreparation({})(test::stereoFrame(0, image, image));
  EXPECT_EQ(features->left.levels.size(), 4U);
  EXPECT_EQ(features->right.levels.size(), 4U);
  EXPECT_GT(features->corners.size(), 50U);
  EXPECT_TRUE(features->descriptors.empty());
}

TEST(FeaturePreparation, FindsAgainInNoiseWhatItFinds) {
  constexpr double kDisparity_px = 12, kNoise_gray = 20;
  const test::Texture texture(53, 12, 60);
  const auto shifted = [&](double x, double y) { return texture(x + kDisparity_px, y); };
  const Image left = test::render(640, 300, texture, {.noise = kNoise_gray, .seed = 2}),
              right = test::render(640, 300, shifted, {.noise = kNoise_gray, .seed = 3});
  const auto rightMatches = [&](const FeaturesPtr& features) {
    const auto matches = StereoMatcher({})(features);
    int right_ones = 0;
    for (std::size_t i = 0; i < features->corners.size(); ++i) {
      const auto match = refinedMatch(*matches, i);
      right_ones += match && std::abs(match->disparity_px - kDisparity_px) < 0.5;
    }
    return right_ones;
  };
  const auto frame = test::stereoFrame(0, left, right);
  const FeaturesPtr features = FeaturePreparation({})(frame);
  ImagePool pool;
  Features as_it_is;
  as_it_is.frame = frame;
  as_it_is.left = buildPyramid(left, FeaturePreparation::kPyramidLevels, pool);
  as_it_is.right = buildPyramid(right, FeaturePreparation::kPyramidLevels, pool);
  as_it_is.corners = CornerDetector({})(left);
  EXPECT_GT(rightMatches(features), 1.5 * rightMatches(std::make_shared<const Features>(as_it_is)));
}

TEST(FeaturePreparation, TakesFaintCornersWhereTheImageIsBlurred) {
  const test::Texture texture(54, 30, 90);
  const Image faint = test::render(640, 300, [&](double x, double y) { return 128 + 0.4 * (texture(x, y) - 128); });
  const auto corners = FeaturePreparation({})(test::stereoFrame(0, faint, faint))->corners.size();
  EXPECT_GT(corners, 2 * CornerDetector({})(faint).size());
  EXPECT_GT(corners, 30U);
}

TEST(FeaturePreparation, SpendsNoCornersOnIgnoredPixels) {
  const Image image = test::render(320, 200, test::Texture(51));
  PixelMask ignored(320, 200);
  ignored.add(0, 100, 320, 200);
  FeaturePreparation::Params params;
  params.corners.max_corners = 100;
  StereoFrame frame = *test::stereoFrame(0, image, image);
  frame.inputs.ignored = sharedMask(ignored);
  const auto features = FeaturePreparation(params)(std::make_shared<const StereoFrame>(frame));
  EXPECT_EQ(features->corners.size(), 100U);  // as many as there may be, all of the upper half
  for (const Corner& corner : features->corners) EXPECT_LT(corner.v_px, 100);
}

TEST(FeaturePreparation, GivesNoImagesForARejectedFrame) {
  const auto features = FeaturePreparation({})(test::rejectedFrame(7));
  EXPECT_EQ(features->frame->head.frame, FrameId{7});
  EXPECT_TRUE(features->left.levels.empty());
  EXPECT_TRUE(features->corners.empty());
}

TEST(FeaturePreparation, GivesTheSameFromSeveralThreads) {
  const FeaturePreparation prepare({});
  const Image image = test::render(320, 200, test::Texture(52));
  const auto frame = test::stereoFrame(0, image, image);
  std::array<FeaturesPtr, 4> results;
  {
    std::vector<std::jthread> threads;
    for (FeaturesPtr& result : results) threads.emplace_back([&] { result = prepare(frame); });
  }
  for (const FeaturesPtr& result : results) {
    ASSERT_EQ(result->corners.size(), results[0]->corners.size());
    for (std::size_t i = 0; i < result->corners.size(); ++i) {
      EXPECT_EQ(result->corners[i].u_px, results[0]->corners[i].u_px);
      EXPECT_EQ(result->corners[i].v_px, results[0]->corners[i].v_px);
    }
  }
}

}  // namespace
}  // namespace motorcade
