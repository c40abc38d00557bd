#include "apps/evaluate/comparison/followed_objects.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "tests/apps/evaluate/compared_frame_by_hand.hpp"

namespace motorcade {
namespace {

/// Sideways offsets of a body from its label [m], frame by frame; their differences are the errors of its motion.
using Offsets = std::vector<double>;

/// Frames in which each label stands still and is followed by the track of its number plus ten.
std::vector<ComparedFrame> framesOf(const std::vector<Offsets>& objects) {
  std::vector<ComparedFrame> frames;
  for (std::size_t i = 0; i < objects.front().size(); ++i) {
    ComparedFrame frame;
    frame.frame.value = 20 + static_cast<std::int64_t>(i);
    for (std::size_t k = 0; k < objects.size(); ++k) {
      if (i >= objects[k].size()) continue;
      const double range_m = 10 + 5 * static_cast<double>(k);
      frame.objects.push_back(test::labelByHand(static_cast<std::int64_t>(k), range_m));
      frame.objects.back().truth.T_world_object = frame.objects.back().truth.T_cam_object;
      frame.rows.push_back(test::rowByHand(static_cast<int>(k) + 10, static_cast<int>(k), range_m, objects[k][i]));
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

constexpr double kMotionRounding = 1e-12;

TEST(FollowedMotion, ThePublishedFormIsTheMeanOverObjectsOfTheirRootMeanSquares) {
  const FollowedMotion motion = followedMotion(framesOf({{0, 0.3, 0.3, 0.7, 0.7}, {0, 0.1}}));  // .3 0 .4 0; .1
  ASSERT_EQ(motion.objects.size(), 2U);
  EXPECT_NEAR(motion.objects[0].me_m.rmse, 0.25, kMotionRounding);
  EXPECT_NEAR(motion.rms_m, (0.25 + 0.1) / 2, kMotionRounding);
  EXPECT_NEAR(motion.rms_deg, 0, 1e-9);
  EXPECT_EQ(motion.me_m.count, 5U);
  EXPECT_NEAR(motion.me_m.mean, 0.8 / 5, kMotionRounding);
  EXPECT_NEAR(motion.me_m.rmse, std::sqrt((0.09 + 0.16 + 0.01) / 5), kMotionRounding) << "not the published form";
  EXPECT_NEAR(motion.me_m.median, 0.1, kMotionRounding);
  EXPECT_NEAR(motion.me_m.p95, 0.38, kMotionRounding) << "a fifth of the way from the largest to the second";
}

TEST(FollowedMotion, TheLargestStepIsNamedWithFrameLabelAndTrack) {
  const FollowedMotion motion = followedMotion(framesOf({{0, 0.1, 0.2, 0.1}, {0, 0, 0.6, 0.6}}));
  EXPECT_NEAR(motion.largest_m.error, 0.6, kMotionRounding);
  EXPECT_EQ(motion.largest_m.error, motion.me_m.max);
  EXPECT_EQ(motion.largest_m.frame.value, 22);
  EXPECT_EQ(motion.largest_m.label, 1);
  EXPECT_EQ(motion.largest_m.track.value, 11);
  EXPECT_EQ(followedMotion({}).largest_m.label, -1);
}

TEST(FollowedMotion, HiddenLabelsAndPredictedRowsCountAndParkedOnesDoNot) {
  auto frames = framesOf({{0, 0.2, 0.4}, {0, 0.1, 0.2}, {0, 0.5, 1.5}, {0}});
  for (ComparedFrame& frame : frames) {
    frame.objects[0].counted = false;
    frame.rows[1].row.object.state = ObjectState::kPredicted;
    frame.objects[2].moving = false;
  }
  const FollowedMotion motion = followedMotion(frames);
  ASSERT_EQ(motion.objects.size(), 2U) << "a single row is no step";
  EXPECT_NEAR(motion.rms_m, (0.2 + 0.1) / 2, kMotionRounding);
}

}  // namespace
}  // namespace motorcade
