#include "frontend/features/sift_features.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "frontend/features/feature_preparation.hpp"
#include "frontend/matching/optical_flow.hpp"
#include "frontend/matching/stereo_matcher.hpp"
#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

constexpr int kWidth = 320, kHeight = 200;
constexpr double kDisparity_px = 12.4;

/// A wall 12.4 px of disparity away that moves (4.2, 1.1) px per frame.
FeaturesPtr wall(int frame) {
  const test::Texture texture(71, 7, 50);
  const auto left = [&](double x, double y) { return texture(x - 4.2 * frame, y - 1.1 * frame); };
  const auto right = [&](double x, double y) { return left(x + kDisparity_px, y); };
  FeaturePreparation::Params params;
  params.detector = DetectorKind::kSift;
  const test::Exposure noisy{.noise = 1, .seed = static_cast<unsigned>(frame)};
  return FeaturePreparation(params)(test::stereoFrame(frame, test::render(kWidth, kHeight, left, noisy),
                                                      test::render(kWidth, kHeight, right, noisy)));
}

TEST(SiftFeatures, MatchLeftAndRightImage) {
  const auto features = wall(0);
  ASSERT_GT(features->corners.size(), 60U);
  ASSERT_EQ(features->descriptors.size(), features->corners.size());
  const auto matches = StereoMatcher({})(features);
  int matched = 0, right = 0;
  for (const auto& match : matches->of_corner) {
    if (!match) continue;
    ++matched;
    right += std::abs(match->disparity_px - kDisparity_px) < 1;
  }
  EXPECT_GT(matched, 0.4 * static_cast<double>(features->corners.size()));
  EXPECT_GT(right, 0.95 * matched);
}

TEST(SiftFeatures, KeepTheirIdsFromFrameToFrame) {
  OpticalFlowTracker track({});
  OpticalFlowPtr before = track(wall(0));
  for (int frame = 1; frame < 4; ++frame) {
    const OpticalFlowPtr now = track(wall(frame));
    int followed = 0, right = 0;
    auto old = before->observations.begin();
    for (const FlowObservation& point : now->observations) {
      EXPECT_EQ(point.age == 1, point.corner >= 0);
      if (point.age == 1) continue;
      old = std::find_if(old, before->observations.end(),
                         [&](const FlowObservation& p) { return p.point == point.point; });
      ASSERT_NE(old, before->observations.end());  // both lists are ordered by id
      EXPECT_EQ(point.age, old->age + 1);
      ++followed;
      right += std::hypot(point.u_px - old->u_px - 4.2F, point.v_px - old->v_px - 1.1F) < 1;
    }
    EXPECT_GT(followed, 0.4 * static_cast<double>(before->observations.size()));
    EXPECT_GT(right, 0.95 * followed);
    before = now;
  }
}

TEST(SiftFeatures, MatchOnlyWithinTheRegionAndBothWays) {
  SiftDescriptor a{}, b{}, near_a{};
  a[0] = 100, b[1] = 100, near_a[0] = 98;
  const std::vector<Corner> from{{50, 50, 1}, {60, 50, 1}}, to{{40, 50.5F, 1}, {10, 50, 1}};
  const SiftSearchRegion region{-20, 0, 1};
  EXPECT_EQ(matchSift(from, {a, near_a}, to, {a, a}, region, 0.9), (std::vector<int>{0, -1}));
  EXPECT_EQ(matchSift(from, {b, a}, to, {a, b}, {-20, -15, 1}, 0.9), (std::vector<int>{-1, 0}));
  EXPECT_EQ(matchSift(from, {a, b}, to, {a, b}, {-20, 0, 0.2}, 0.9), (std::vector<int>{-1, -1}));
}

}  // namespace
}  // namespace motorcade
