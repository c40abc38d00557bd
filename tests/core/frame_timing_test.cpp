#include "core/frame_timing.hpp"

#include <gtest/gtest.h>

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
  for (const Stage stage : {Stage::kPrepare, Stage::kStereoMatching, Stage::kOpticalFlow, Stage::kSceneFlowSegmentation,
                            Stage::kTracking, Stage::kIncrementalOptimization, Stage::kObjectShapes}) {
    const auto start = ready + milliseconds(static_cast<int>(stage));
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
    EXPECT_NEAR(frame.wait_ms(static_cast<Stage>(stage)), static_cast<double>(stage), kTick_ms) << kStageNames[stage];
  EXPECT_NEAR(frame.publish_wait_ms(), 3, kTick_ms);
  frame.of(Stage::kStereoMatching).end = frame.of(Stage::kSceneFlowSegmentation).start;  // the last of two to end
  EXPECT_NEAR(frame.wait_ms(Stage::kSceneFlowSegmentation), 0, kTick_ms);
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
