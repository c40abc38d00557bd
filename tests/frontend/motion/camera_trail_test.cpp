#include "frontend/motion/camera_trail.hpp"

#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

const SE3 kTrailStep(expSO3({0, 0.02, 0}), {0.1, 0, 1});

CameraTrail trailOf(int frames) {
  CameraTrail trail;
  for (int k = 0; k < frames; ++k) trail.add({k * 100'000'000}, k ? kTrailStep : SE3{});
  return trail;
}

TEST(CameraTrail, RelatesTheNewestFrameToEarlierOnes) {
  const CameraTrail trail = trailOf(4);
  ASSERT_TRUE(trail.find(1));
  EXPECT_THAT(trail.find(1)->T_then_now, test::IsNearPose(kTrailStep * kTrailStep, 1e-12));  // rounding
  EXPECT_NEAR(trail.find(1)->dt_s, -0.2, 1e-12);
  ASSERT_TRUE(trail.find(3));
  EXPECT_THAT(trail.find(3)->T_then_now, test::IsNearPose(SE3{}, 1e-12));
  EXPECT_EQ(trail.find(3)->dt_s, 0);
}

TEST(CameraTrail, KnowsNeitherForgottenNorComingFrames) {
  EXPECT_TRUE(CameraTrail{}.empty());
  EXPECT_FALSE(CameraTrail{}.find(0));
  const CameraTrail trail = trailOf(CameraTrail::kCapacity + 3);
  EXPECT_EQ(trail.newest().step, CameraTrail::kCapacity + 2);
  EXPECT_FALSE(trail.find(-1));
  EXPECT_FALSE(trail.find(2));
  EXPECT_TRUE(trail.find(3));
  EXPECT_FALSE(trail.find(CameraTrail::kCapacity + 3));
}

}  // namespace
}  // namespace motorcade
