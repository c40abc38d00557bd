#include "core/frame_timing.hpp"

#include <gmock/gmock.h>

namespace motorcade {
namespace {

using std::chrono::milliseconds;

constexpr double kTick_ms = 1e-9;

/// Each stage waits a millisecond for each stage before it in the list, and works for two.
FrameTiming timing() {
  FrameTiming timing;
  timing.due = SteadyTime(milliseconds(1000));
  timing.admitted = timing.due + milliseconds(5);
  SteadyTime ready = timing.admitted;
  for (std::size_t i = 0; i < kStageCount; ++i) {
    const auto stage = static_cast<Stage>(i);
    const auto start = ready + milliseconds(static_cast<int>(i));
    timing.of(stage) = {start, start + milliseconds(2), 0};
    if (stage != Stage::kStereoMatching) ready = timing.of(stage).end;  // flow starts when it does, not after it
    if (stage == Stage::kStereoMatching) ready = timing.of(Stage::kPrepare).end;
  }
  timing.published = timing.of(Stage::kObjectShapes).end + milliseconds(3);
  return timing;
}

TEST(FrameTiming, AStageWaitsFromWhenAllItNeedsWasThere) {
  FrameTiming frame = timing();
  EXPECT_NEAR(frame.entry_wait_ms(), 5, kTick_ms);
  for (std::size_t stage = 0; stage < kStageCount; ++stage)
    EXPECT_NEAR(frame.wait_ms(static_cast<Stage>(stage)), static_cast<double>(stage), kTick_ms) << kStageKeys[stage];
  EXPECT_NEAR(frame.publish_wait_ms(), 3, kTick_ms);
  frame.of(Stage::kStereoMatching).end = frame.of(Stage::kSceneFlowSegmentation).start;  // the last of two to end
  EXPECT_NEAR(frame.wait_ms(Stage::kSceneFlowSegmentation), 0, kTick_ms);
}

TEST(Stages, AreNamedByTheWordsOfTheirKeys) {
  EXPECT_EQ(nameOf(Stage::kPrepare), "prepare");
  EXPECT_EQ(nameOf(Stage::kSceneFlowSegmentation), "scene flow segmentation");
}

TEST(Stages, ThePathOfAFrameLeavesOutOneBranch) {
  EXPECT_THAT(pathOver(Stage::kStereoMatching),
              testing::ElementsAre(Stage::kPrepare, Stage::kStereoMatching, Stage::kSceneFlowSegmentation,
                                   Stage::kTracking, Stage::kIncrementalOptimization, Stage::kObjectShapes));
  EXPECT_EQ(pathOver(Stage::kOpticalFlow)[1], Stage::kOpticalFlow);
}

TEST(FrameTiming, WhatNeverHappenedTakesNoTime) {
  FrameTiming frame;  // as of a frame that was dropped
  frame.due = frame.published = SteadyTime(milliseconds(1000));
  EXPECT_EQ(frame.entry_wait_ms(), 0);
  EXPECT_EQ(frame.wait_ms(Stage::kTracking), 0);
  EXPECT_EQ(frame.publish_wait_ms(), 0);
}

}  // namespace
}  // namespace motorcade
