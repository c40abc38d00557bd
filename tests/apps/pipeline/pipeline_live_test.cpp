#include <atomic>
#include <cstdint>
#include <latch>
#include <thread>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/pipeline/pipeline.hpp"
#include "tests/apps/pipeline/toy_stages.hpp"

/// The live policy. Stages and camera wait for each other here, so that nothing depends on the speed of the machine:
/// time is counted in pairs that the camera has delivered.
namespace motorcade {
namespace {

using testing::ElementsAre;

void waitUntilAtLeast(std::atomic<std::int64_t>& value, std::int64_t wanted) {
  for (auto now = value.load(); now < wanted; now = value.load()) value.wait(now);
}

void raiseTo(std::atomic<std::int64_t>& value, std::int64_t wanted) {
  value.store(wanted);
  value.notify_all();
}

std::int64_t missing(const PipelineSummary& summary) {
  return summary.received - summary.processed - summary.dropped - summary.rejected;
}

/// Takes the rest of a run whose producer is done.
Outcome drain(Pipeline& pipeline) { return runThrough(pipeline, {}); }

class LiveOverload : public testing::TestWithParam<std::tuple<int, int>> {};
INSTANTIATE_TEST_SUITE_P(ThreadsAndFactor, LiveOverload,
                         testing::Combine(testing::Values(1, 2, 4), testing::Values(1, 2, 5)));

/// The camera delivers `factor` more pairs while a frame is in work. The newest of them comes next, so that a result is
/// never older than the pairs of one processing time.
TEST_P(LiveOverload, ProcessesTheNewestPairEachTime) {
  const auto [threads, factor] = GetParam();
  constexpr std::int64_t kProcessed = 40;
  std::atomic<std::int64_t> ordered = 1, delivered = 0;  // pairs
  ToyStages toys;
  toys.work = [&, times = factor](Stage stage, FrameId frame) {
    if (stage != Stage::kSceneFlowSegmentation || frame.value >= (kProcessed - 1) * times) return;
    raiseTo(ordered, frame.value + 1 + times);
    waitUntilAtLeast(delivered, frame.value + 1 + times);
  };
  Pipeline pipeline({.threads = threads, .policy = InputPolicy::kLive}, toys.stages());
  std::jthread camera([&, times = factor] {
    for (std::int64_t index = 0; index <= (kProcessed - 1) * times; ++index) {
      waitUntilAtLeast(ordered, index + 1);
      pipeline.push(frameAt(index));
      raiseTo(delivered, index + 1);
    }
    pipeline.close();
  });
  std::vector<PipelineResult> results;
  while (auto result = pipeline.next()) results.push_back(std::move(*result));
  camera.join();
  const PipelineEnd end = pipeline.finish();

  ASSERT_EQ(results.size(), static_cast<std::size_t>(kProcessed));
  for (std::int64_t index = 0; index < kProcessed; ++index) {
    EXPECT_EQ(results[index].online.head.frame.value, index * factor);
    EXPECT_EQ(results[index].dropped.size(), static_cast<std::size_t>(index == 0 ? 0 : factor - 1));
  }
  EXPECT_EQ(end.summary.received, (kProcessed - 1) * factor + 1);
  EXPECT_EQ(end.summary.processed, kProcessed);
  EXPECT_EQ(end.summary.dropped, (kProcessed - 1) * (factor - 1));
  EXPECT_EQ(missing(end.summary), 0);
}

/// A stage stalls in the first frame, until the camera has delivered all others.
Outcome runThroughAStall(Stage of, PipelineParams params, std::int64_t frames) {
  std::latch stalled(1), stall_ends(1);
  ToyStages toys;
  toys.work = [&](Stage stage, FrameId frame) {
    if (stage != of || frame.value != 0) return;
    stalled.count_down();
    stall_ends.wait();
  };
  params.policy = InputPolicy::kLive;
  Pipeline pipeline(params, toys.stages());
  pipeline.push(frameAt(0));
  stalled.wait();
  for (std::int64_t index = 1; index < frames; ++index) pipeline.push(frameAt(index));
  stall_ends.count_down();
  return drain(pipeline);
}

TEST(PipelineLive, IsFreshInTheFrameAfterAStallOfTheMotionStage) {
  const Outcome run = runThroughAStall(Stage::kSceneFlowSegmentation, {.threads = 2}, 200);
  EXPECT_THAT(idsOf(run.results), ElementsAre(0, 199));
  EXPECT_EQ(idsOf(run.finals), numbersTo(200));
  EXPECT_EQ(run.summary.dropped, 198);
  EXPECT_EQ(missing(run.summary), 0);
}

TEST(PipelineLive, CountsMoreDroppedPairsThanItCanName) {
  constexpr std::int64_t kFrames = 20'000;
  const Outcome run = runThroughAStall(Stage::kSceneFlowSegmentation, {.threads = 2}, kFrames);
  ASSERT_EQ(run.results.size(), 2u);
  const PipelineResult& fresh = run.results.back();
  EXPECT_EQ(static_cast<std::int64_t>(fresh.dropped.size()) + fresh.dropped_unnamed, kFrames - 2);
  EXPECT_EQ(run.summary.dropped, kFrames - 2);
}

/// One frame is admitted behind the one that stalls, and no more: the third is fresh.
TEST(PipelineLive, IsFreshWithinThreeFramesAfterAStallOfTheBackEnd) {
  const Outcome run = runThroughAStall(Stage::kIncrementalOptimization, {.threads = 4, .frames_in_flight = 2}, 200);
  ASSERT_GE(run.results.size(), 2u);
  ASSERT_LE(run.results.size(), 3u);
  EXPECT_EQ(run.results.back().online.head.frame.value, 199);
  EXPECT_EQ(missing(run.summary), 0);
}

/// The results that wait for a consumer and the frames behind them are bounded; the camera goes on meanwhile, and the
/// next frame is new.
TEST(PipelineLive, NeitherBlocksTheCameraNorPilesUpWhenNoResultIsTaken) {
  constexpr std::int64_t kFrames = 1000;
  constexpr int kInFlight = 4;
  ToyStages toys;
  Pipeline pipeline({.threads = 2, .frames_in_flight = kInFlight, .policy = InputPolicy::kLive}, toys.stages());
  for (std::int64_t index = 0; index < kFrames; ++index) pipeline.push(frameAt(index));
  const Outcome run = drain(pipeline);
  EXPECT_LE(run.results.size(), static_cast<std::size_t>(kInFlight + 2 + 1));  // waiting, in flight, and the newest
  EXPECT_EQ(run.results.back().online.head.frame.value, kFrames - 1);
  EXPECT_EQ(idsOf(run.finals), numbersTo(kFrames));
  EXPECT_EQ(run.summary.received, kFrames);
  EXPECT_EQ(missing(run.summary), 0);
}

TEST(PipelineLive, AccountsForRejectedPairsToo) {
  ToyStages toys;
  Pipeline pipeline({.threads = 2, .policy = InputPolicy::kLive}, toys.stages());
  auto frames = framesFrom0To(300);
  for (std::size_t index = 0; index < frames.size(); index += 3)
    frames[index].reject(FrameCause::kUnusable, "unreadable");
  frames.back().reject(FrameCause::kUnusable, "unreadable");  // never dropped
  const Outcome run = runThrough(pipeline, std::move(frames));
  EXPECT_EQ(run.summary.received, 300);
  EXPECT_GE(run.summary.rejected, 1);
  EXPECT_EQ(missing(run.summary), 0);
}

/// A reader of files that is too slow to play the camera leaves pairs out before they are decoded.
TEST(PipelineLive, CountsPairsThatWerePassedOverAndGivesThemALine) {
  ToyStages toys;
  Pipeline pipeline({.threads = 2, .policy = InputPolicy::kLive}, toys.stages());
  std::jthread camera([&] {
    for (std::int64_t index = 0; index < 91; ++index) {
      if (index % 10 == 0)
        pipeline.push(frameAt(index));
      else
        pipeline.passOver({index}, {index * kPeriod_ns});
    }
    pipeline.close();
  });
  camera.join();
  const Outcome run = drain(pipeline);
  EXPECT_EQ(idsOf(run.finals), numbersTo(91));
  EXPECT_EQ(run.summary.received, 91);
  EXPECT_GE(run.summary.dropped, 81);
  EXPECT_EQ(missing(run.summary), 0);
}

TEST(PipelineLive, CanBeAbandonedWhileFramesWait) {
  for (int frames = 0; frames < 20; ++frames) {
    ToyStages toys;
    Pipeline pipeline({.threads = 2, .policy = InputPolicy::kLive}, toys.stages());
    for (int index = 0; index < frames; ++index) pipeline.push(frameAt(index));
  }
}

}  // namespace
}  // namespace motorcade
