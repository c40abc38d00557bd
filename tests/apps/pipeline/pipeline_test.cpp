#include "apps/pipeline/pipeline.hpp"

#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/pipeline/toy_stages.hpp"

namespace motorcade {
namespace {

constexpr auto kAllStages = [] {
  std::array<Stage, kStageCount> stages{};
  for (std::size_t i = 0; i < kStageCount; ++i) stages[i] = static_cast<Stage>(i);
  return stages;
}();

using std::chrono::milliseconds;
using testing::HasSubstr;

/// Frame-dependent pauses that make later frames overtake earlier ones wherever the wiring lets them.
void unevenWork(Stage stage, FrameId frame) {
  const auto mixed = static_cast<std::uint64_t>(frame.value * 7 + static_cast<int>(stage) * 3) * 2654435761u;
  std::this_thread::sleep_for(std::chrono::microseconds(mixed % 5 == 0 ? 900 : mixed % 200));
}

class PipelineThreads : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(OneTwoAndFour, PipelineThreads, testing::Values(1, 2, 4));

TEST_P(PipelineThreads, PublishesEveryFrameInOrder) {
  constexpr std::int64_t kFrames = 200;
  ToyStages toys{.work = unevenWork};
  Pipeline pipeline({.threads = GetParam()}, toys.stages());
  const Outcome run = runThrough(pipeline, framesFrom0To(kFrames));
  EXPECT_EQ(idsOf(run.results), numbersTo(kFrames));
  EXPECT_EQ(idsOf(run.finals), numbersTo(kFrames));
  EXPECT_EQ(toys.order_of_flow, numbersTo(kFrames));
  EXPECT_EQ(toys.order_of_motion, numbersTo(kFrames));
  EXPECT_EQ(toys.order_of_backend, numbersTo(kFrames));
  EXPECT_FALSE(toys.branches_met_wrongly);
  EXPECT_EQ(run.summary.received, kFrames);
  EXPECT_EQ(run.summary.processed, kFrames);
}

TEST_P(PipelineThreads, KeepsEveryQueueWithinTheFramesInFlight) {
  for (const int in_flight : {1, 2, 3, 6}) {
    ToyStages toys{.work = unevenWork};
    Pipeline pipeline({.threads = GetParam(), .frames_in_flight = in_flight}, toys.stages());
    const Outcome run = runThrough(pipeline, framesFrom0To(60));
    ASSERT_EQ(run.summary.queues.size(), 11u);
    for (const QueueMark& queue : run.summary.queues) {
      EXPECT_GE(queue.high_water, 1) << queue.name;
      EXPECT_LE(queue.high_water, in_flight) << queue.name;
    }
  }
}

TEST_P(PipelineThreads, UsesNoMoreWorkersThanItWasGiven) {
  std::atomic<int> active = 0, most = 0;
  ToyStages toys{.work = [&](Stage, FrameId) {
    most = std::max(most.load(), ++active);
    std::this_thread::sleep_for(std::chrono::microseconds(300));
    --active;
  }};
  Pipeline pipeline({.threads = GetParam()}, toys.stages());
  runThrough(pipeline, framesFrom0To(60));
  EXPECT_LE(most, GetParam());
}

TEST_P(PipelineThreads, SurvivesAStageThatThrows) {
  for (const Stage broken : kAllStages) {
    std::mutex mutex;
    std::vector<std::string> log;
    ToyStages toys{.work = [&](Stage stage, FrameId frame) {
      if (stage == broken && (frame.value == 3 || frame.value == 7)) throw std::runtime_error("toy trouble");
    }};
    Pipeline pipeline({.threads = GetParam()}, toys.stages(), [&](LogLevel level, const std::string& text) {
      const std::lock_guard lock(mutex);
      if (level == LogLevel::kError) log.push_back(text);
    });
    const Outcome run = runThrough(pipeline, framesFrom0To(10));
    EXPECT_EQ(idsOf(run.results), numbersTo(10));
    EXPECT_EQ(idsOf(run.finals), numbersTo(10));
    EXPECT_EQ(idsOf(run.settled), numbersTo(9));  // the last one is final before it has settled
    ASSERT_EQ(log.size(), 2u);
    EXPECT_THAT(log[0], HasSubstr("frame 3: "));
    EXPECT_THAT(log[1], HasSubstr("toy trouble"));
    EXPECT_THAT(run.results[3].problem, HasSubstr("toy trouble"));
    EXPECT_EQ(run.results[4].problem, "");
    EXPECT_EQ(run.summary.received, run.summary.processed + run.summary.rejected);
    EXPECT_EQ(run.summary.rejected, broken == Stage::kPrepare ? 2 : 0);
    // One meter per frame, predicted or measured.
    EXPECT_NEAR(run.results[3].online.T_world_cam.translation().z(), 3, 1e-9);
    EXPECT_NEAR(run.finals[3].T_world_cam.translation().z(), broken == Stage::kIncrementalOptimization ? 2.5 : 3, 1e-9);
  }
}

TEST_P(PipelineThreads, GivesTheSameResultsForEveryNumberOfThreads) {
  ToyStages toys{.work = unevenWork}, reference;
  Pipeline pipeline({.threads = GetParam()}, toys.stages()),
      single({.threads = 1, .frames_in_flight = 1}, reference.stages());
  const Outcome run = runThrough(pipeline, framesFrom0To(50)), expected = runThrough(single, framesFrom0To(50));
  for (std::size_t frame = 0; frame < 50; ++frame)
    EXPECT_EQ(run.finals[frame].T_world_cam.translation(), expected.finals[frame].T_world_cam.translation());
}

TEST_P(PipelineThreads, AFrameForWhichAStageLacksMemoryIsLostAndTheRunGoesOn) {
  for (const Stage broken : kAllStages) {
    SCOPED_TRACE(nameOf(broken));
    ToyStages toys{.work = [&](Stage stage, FrameId frame) {
      if (stage == broken && frame.value == 3) throw std::bad_alloc();
    }};
    Pipeline pipeline({.threads = GetParam()}, toys.stages());
    const Outcome run = runThrough(pipeline, framesFrom0To(10));
    EXPECT_EQ(idsOf(run.results), numbersTo(10));
    EXPECT_FALSE(run.results[3].problem.empty());
    EXPECT_TRUE(run.results[4].problem.empty());
  }
}

TEST(Pipeline, AFrameWhoseShapesFailReportsOnlyObjectsOfKnownExistence) {
  ToyStages toys{.work = [](Stage stage, FrameId frame) {
    if (stage == Stage::kObjectShapes && (frame.value == 3 || frame.value == 6))
      throw std::runtime_error("toy trouble");
  }};
  toys.object_from = {3};
  Pipeline pipeline({}, toys.stages());
  const Outcome run = runThrough(pipeline, framesFrom0To(10));
  EXPECT_THAT(run.results[3].online.objects, testing::IsEmpty());  // nothing is known of the new object yet
  ASSERT_EQ(run.results[6].online.objects.size(), 1u);
  EXPECT_EQ(run.results[6].online.objects[0].existence_probability, 0.75);
}

TEST(Pipeline, AFrameWhoseSegmentationFailsStaysInTheSegment) {
  ToyStages toys{.work = [](Stage stage, FrameId frame) {
    if (stage == Stage::kSceneFlowSegmentation && frame.value == 3) throw std::runtime_error("toy trouble");
  }};
  toys.segment = 2;
  Pipeline pipeline({}, toys.stages());
  for (const PipelineResult& result : runThrough(pipeline, framesFrom0To(5)).results)
    EXPECT_EQ(result.online.head.segment, 2);
}

TEST(Pipeline, FramesSettleAtTheLatestWhenTheyLeaveTheWindow) {
  ToyStages toys{.settles = false};
  Pipeline pipeline({}, toys.stages());
  EXPECT_EQ(idsOf(runThrough(pipeline, framesFrom0To(10)).settled), numbersTo(8));
}

TEST(Pipeline, GivesOneResultForARejectedFrame) {
  ToyStages toys;
  Pipeline pipeline({}, toys.stages());
  auto frames = framesFrom0To(6);
  frames[2].reject(FrameCause::kUnusable, "left/000002.png: cut off");
  const Outcome run = runThrough(pipeline, std::move(frames));
  ASSERT_EQ(run.results.size(), 6u);
  EXPECT_EQ(run.results[2].online.head.status, FrameStatus::kRejected);
  EXPECT_EQ(run.results[2].problem, "left/000002.png: cut off");
  EXPECT_EQ(run.summary.rejected, 1);
  EXPECT_EQ(run.summary.processed, 5);
}

TEST(Pipeline, NumbersFramesThatHaveNoId) {
  ToyStages toys;
  Pipeline pipeline({}, toys.stages());
  auto frames = framesFrom0To(4);
  for (StereoFrame& frame : frames) frame.head.frame = FrameId{};
  EXPECT_EQ(idsOf(runThrough(pipeline, std::move(frames)).results), numbersTo(4));
}

TEST(Pipeline, DropsOldFramesWhenLiveAndAccountsForAll) {
  constexpr std::int64_t kFrames = 60;
  ToyStages toys{.work = [](Stage stage, FrameId) {
    if (stage == Stage::kSceneFlowSegmentation)
      std::this_thread::sleep_for(milliseconds(5));  // five times the camera's period
  }};
  Pipeline pipeline({.policy = InputPolicy::kLive}, toys.stages());
  auto frames = framesFrom0To(kFrames);
  frames[kFrames - 1].reject(FrameCause::kUnusable, "unreadable");  // the last one is never dropped
  const Outcome run = runThrough(pipeline, std::move(frames), milliseconds(1));
  EXPECT_EQ(run.summary.received, kFrames);
  EXPECT_EQ(run.summary.received, run.summary.processed + run.summary.dropped + run.summary.rejected);
  EXPECT_GT(run.summary.dropped, 0);
  EXPECT_EQ(run.summary.rejected, 1);
  EXPECT_EQ(idsOf(run.finals), numbersTo(kFrames));

  std::vector<FrameEstimate> online;
  for (const PipelineResult& result : run.results) {
    for (const FrameEstimate& dropped : result.dropped) {
      EXPECT_EQ(dropped.head.status, FrameStatus::kDropped);
      EXPECT_EQ(dropped.head.stamp.ns, dropped.head.frame.value * kPeriod_ns);
      online.push_back(dropped);
    }
    online.push_back(result.online);
  }
  EXPECT_EQ(idsOf(online), numbersTo(kFrames));
}

/// Ends as when there is no memory to tell of a frame that was lost for want of memory.
TEST(Pipeline, EndsWithTheReasonWhenItCannotTellOfAFrame) {
  ToyStages toys{.work = [](Stage stage, FrameId frame) {
    if (stage == Stage::kTracking && frame.value == 3) throw std::runtime_error("toy trouble");
  }};
  Pipeline pipeline({.threads = 2}, toys.stages(),
                    [](LogLevel, const std::string&) { throw std::logic_error("no paper left"); });
  std::jthread producer([&] {
    for (StereoFrame& frame : framesFrom0To(50))
      if (!isTaken(pipeline.push(std::move(frame)))) return;
  });
  std::vector<PipelineResult> results;
  while (auto result = pipeline.next()) results.push_back(std::move(*result));
  EXPECT_THROW(pipeline.finish(), std::logic_error);
  // Those before the third may be in later stages when it fails, and be lost with it.
  const std::vector<std::int64_t> ids = idsOf(results);
  ASSERT_LE(ids.size(), 3u);
  for (std::size_t i = 0; i < ids.size(); ++i) EXPECT_EQ(ids[i], static_cast<std::int64_t>(i));
}

TEST(Pipeline, EndsWhenNothingWasPushed) {
  ToyStages toys;
  Pipeline pipeline({}, toys.stages());
  const PipelineEnd end = pipeline.finish();
  EXPECT_TRUE(end.results.empty());
  EXPECT_TRUE(end.finals.empty());
  EXPECT_EQ(end.summary.received, 0);
}

TEST(Pipeline, CanBeAbandonedAtAnyMoment) {
  for (int frames = 0; frames < 8; ++frames) {
    ToyStages toys{.work = unevenWork};
    Pipeline pipeline({.frames_in_flight = 8}, toys.stages());
    for (int index = 0; index < frames; ++index) EXPECT_TRUE(isTaken(pipeline.push(frameAt(index))));
  }
}

/// Lets the stage at work end and begins no other, so that whoever ends a pipeline need not wait for whole frames.
TEST(Pipeline, BeginsNoFurtherStageOnceItIsAbandoned) {
  std::atomic<bool> works{false}, abandoned{false};
  std::atomic<int> later{0};
  ToyStages toys{.work = [&](Stage stage, FrameId) {
    if (stage == Stage::kPrepare) {
      works = true;
      works.notify_all();
      abandoned.wait(false);
    } else {
      ++later;
    }
  }};
  {
    Pipeline pipeline({.frames_in_flight = 4}, toys.stages());
    for (int index = 0; index < 4; ++index) EXPECT_TRUE(isTaken(pipeline.push(frameAt(index))));
    works.wait(false);
    pipeline.abandon();
    abandoned = true;
    abandoned.notify_all();
  }
  EXPECT_EQ(later, 0);
}

TEST(Pipeline, KeepsNoImageAliveThroughItsResults) {
  ToyStages toys;
  ImagePool pool;
  Pipeline pipeline({}, toys.stages());
  std::vector<PipelineResult> results;
  for (int index = 0; index < 50; ++index) {
    StereoFrame frame = frameAt(index);
    frame.left = pool.acquire(64, 32);
    ASSERT_TRUE(isTaken(pipeline.push(std::move(frame))));
    results.push_back(*pipeline.next());
  }
  EXPECT_LE(pool.buffersMade(), 3u);  // the frame in work, and two that their last owners are just letting go
}

TEST(Pipeline, RecordsWhenEachStageWorked) {
  ToyStages toys{.work = [](Stage, FrameId) { std::this_thread::sleep_for(milliseconds(1)); }};
  Pipeline pipeline({}, toys.stages());
  const Outcome run = runThrough(pipeline, framesFrom0To(5));
  for (const PipelineResult& result : run.results) {
    const FrameTiming& timing = result.timing;
    for (const StageSpan& span : timing.stages) {
      EXPECT_GE(span.duration_ms(), 1);
      EXPECT_GE(span.worker, 0);
      EXPECT_GE(span.start, timing.admitted);
      EXPECT_LE(span.end, timing.published);
    }
    EXPECT_GE(timing.of(Stage::kSceneFlowSegmentation).start, timing.of(Stage::kStereoMatching).end);
    EXPECT_GE(timing.of(Stage::kSceneFlowSegmentation).start, timing.of(Stage::kOpticalFlow).end);
    EXPECT_GE(timing.latency_ms(), 5);
  }
  EXPECT_EQ(run.summary.latency.count(), 5);
}

TEST(Pipeline, RefusesImpossibleParameters) {
  ToyStages toys;
  EXPECT_THROW(Pipeline({.threads = 0}, toys.stages()), std::invalid_argument);
  EXPECT_THROW(Pipeline({.frames_in_flight = 0}, toys.stages()), std::invalid_argument);
}

}  // namespace
}  // namespace motorcade
