#include "frontend/features/feature_preparation.hpp"

#include <thread>

#include <gtest/gtest.h>

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

TEST(FeaturePreparation, GivesNoImagesForARejectedFrame) {
  const auto features = FeaturePreparation({})(test::rejectedFrame(7));
  EXPECT_EQ(features->frame->frame, FrameId{7});
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
