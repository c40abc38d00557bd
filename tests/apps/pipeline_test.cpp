#include "apps/pipeline/pipeline.hpp"

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace motorcade {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr std::int64_t kPeriod_ns = 100'000'000;

StereoFrame frameAt(std::int64_t index) {
  StereoFrame frame;
  frame.frame = {index};
  frame.stamp = {index * kPeriod_ns};
  return frame;
}

/// Stages that carry the frame's number through, take as long as `work` says, and move the camera by one metre per frame.
struct ToyStages {
  std::function<void(Stage, FrameId)> work = [](Stage, FrameId) {};
  std::vector<std::int64_t> order_of_flow{}, order_of_motion{}, order_of_backend{};
  double travelled_m = 0;
  std::vector<FrameEstimate> window{};  // keeps two frames
  bool branches_met_wrongly = false;

  Stages stages() {
    return {.prepare = [this](const StereoFramePtr& m) { return prepare(m); },
            .stereo = [this](const FeaturesPtr& m) { return stereo(m); },
            .flow = [this](const FeaturesPtr& m) { return flow(m); },
            .motion = [this](const StereoMatchesPtr& s, const OpticalFlowPtr& f) { return motion(s, f); },
            .tracking = [this](const SceneMotionPtr& m) { return tracking(m); },
            .optimisation = [this](const FrameMeasurementsPtr& m) { return optimise(m); },
            .finish = [this] { return std::exchange(window, {}); }};
  }

  FeaturesPtr prepare(const StereoFramePtr& frame) {
    work(Stage::kPrepare, frame->frame);
    Features features;
    features.frame = frame;
    return std::make_shared<const Features>(features);
  }
  StereoMatchesPtr stereo(const FeaturesPtr& features) {
    work(Stage::kStereo, features->frame->frame);
    return std::make_shared<const StereoMatches>(StereoMatches{features, {}});
  }
  OpticalFlowPtr flow(const FeaturesPtr& features) {
    work(Stage::kFlow, features->frame->frame);
    order_of_flow.push_back(features->frame->frame.value);
    return std::make_shared<const OpticalFlow>(OpticalFlow{features, {}});
  }
  SceneMotionPtr motion(const StereoMatchesPtr& matches, const OpticalFlowPtr& flow) {
    const StereoFrame& frame = *flow->features->frame;
    work(Stage::kMotion, frame.frame);
    if (matches->features != flow->features) branches_met_wrongly = true;
    order_of_motion.push_back(frame.frame.value);
    SceneMotion result;
    result.frame = frame.frame;
    result.stamp = frame.stamp;
    result.status = frame.rejected() ? FrameStatus::kRejected : FrameStatus::kGood;
    result.T_previous_now = SE3(Eigen::Matrix3d::Identity(), {0, 0, order_of_motion.size() > 1 ? 1.0 : 0.0});
    return std::make_shared<const SceneMotion>(result);
  }
  FrameMeasurementsPtr tracking(const SceneMotionPtr& motion) {
    work(Stage::kTracking, motion->frame);
    FrameMeasurements result;
    result.frame = motion->frame;
    result.stamp = motion->stamp;
    result.status = motion->status;
    result.T_previous_now = motion->T_previous_now;
    return std::make_shared<const FrameMeasurements>(result);
  }
  EstimatesPtr optimise(const FrameMeasurementsPtr& measurements) {
    work(Stage::kOptimisation, measurements->frame);
    order_of_backend.push_back(measurements->frame.value);
    travelled_m += measurements->T_previous_now.translation().z();
    Estimates result;
    result.online.frame = measurements->frame;
    result.online.stamp = measurements->stamp;
    result.online.status = measurements->status;
    result.online.T_world_cam = SE3(Eigen::Matrix3d::Identity(), {0, 0, travelled_m});
    window.push_back(result.online);
    if (window.size() > 2) {
      result.finals.push_back(window.front());
      window.erase(window.begin());
    }
    return std::make_shared<const Estimates>(result);
  }
};

struct Outcome {
  std::vector<PipelineResult> results;
  std::vector<FrameEstimate> finals;
  PipelineSummary summary;
};

/// Pushes from a second thread, takes results on this one.
Outcome runThrough(Pipeline& pipeline, std::vector<StereoFrame> frames, milliseconds period = milliseconds(0)) {
  std::jthread producer([&] {
    for (StereoFrame& frame : frames) {
      pipeline.push(std::move(frame));
      if (period.count() > 0) std::this_thread::sleep_for(period);
    }
    pipeline.close();
  });
  Outcome run;
  const auto keep = [&run](PipelineResult result) {
    for (const FrameEstimate& estimate : result.finals) run.finals.push_back(estimate);
    run.results.push_back(std::move(result));
  };
  while (auto result = pipeline.next()) keep(std::move(*result));
  PipelineEnd end = pipeline.finish();
  for (PipelineResult& result : end.results) keep(std::move(result));
  for (const FrameEstimate& estimate : end.finals) run.finals.push_back(estimate);
  run.summary = end.summary;
  return run;
}

std::vector<StereoFrame> framesFrom0To(std::int64_t count) {
  std::vector<StereoFrame> frames;
  for (std::int64_t index = 0; index < count; ++index) frames.push_back(frameAt(index));
  return frames;
}

std::vector<std::int64_t> numbersTo(std::int64_t count) {
  std::vector<std::int64_t> numbers;
  for (std::int64_t index = 0; index < count; ++index) numbers.push_back(index);
  return numbers;
}

std::vector<std::int64_t> idsOf(const std::vector<FrameEstimate>& estimates) {
  std::vector<std::int64_t> ids;
  for (const FrameEstimate& estimate : estimates) ids.push_back(estimate.frame.value);
  return ids;
}

std::vector<std::int64_t> idsOf(const std::vector<PipelineResult>& results) {
  std::vector<std::int64_t> ids;
  for (const PipelineResult& result : results) ids.push_back(result.online.frame.value);
  return ids;
}

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
    ASSERT_EQ(run.summary.queues.size(), 10u);
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
  for (const Stage broken : {Stage::kPrepare, Stage::kStereo, Stage::kFlow, Stage::kMotion, Stage::kTracking, Stage::kOptimisation}) {
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
    ASSERT_EQ(log.size(), 2u);
    EXPECT_THAT(log[0], HasSubstr("frame 3: "));
    EXPECT_THAT(log[1], HasSubstr("toy trouble"));
    EXPECT_THAT(run.results[3].problem, HasSubstr("toy trouble"));
    EXPECT_EQ(run.results[4].problem, "");
    EXPECT_EQ(run.summary.received, run.summary.processed + run.summary.rejected);
    EXPECT_EQ(run.summary.rejected, broken == Stage::kPrepare ? 2 : 0);
    // One metre per frame, predicted or measured.
    EXPECT_NEAR(run.results[3].online.T_world_cam.translation().z(), 3, 1e-9);
    EXPECT_NEAR(run.finals[3].T_world_cam.translation().z(), broken == Stage::kOptimisation ? 2.5 : 3, 1e-9);
  }
}

TEST_P(PipelineThreads, GivesTheSameResultsForEveryNumberOfThreads) {
  ToyStages toys{.work = unevenWork}, reference;
  Pipeline pipeline({.threads = GetParam()}, toys.stages()), single({.threads = 1, .frames_in_flight = 1}, reference.stages());
  const Outcome run = runThrough(pipeline, framesFrom0To(50)), expected = runThrough(single, framesFrom0To(50));
  for (std::size_t frame = 0; frame < 50; ++frame)
    EXPECT_EQ(run.finals[frame].T_world_cam.translation(), expected.finals[frame].T_world_cam.translation());
}

TEST(Pipeline, GivesOneResultForARejectedFrame) {
  ToyStages toys;
  Pipeline pipeline({}, toys.stages());
  auto frames = framesFrom0To(6);
  frames[2].problem = "left/000002.png: cut off";
  const Outcome run = runThrough(pipeline, std::move(frames));
  ASSERT_EQ(run.results.size(), 6u);
  EXPECT_EQ(run.results[2].online.status, FrameStatus::kRejected);
  EXPECT_EQ(run.results[2].problem, "left/000002.png: cut off");
  EXPECT_EQ(run.summary.rejected, 1);
  EXPECT_EQ(run.summary.processed, 5);
}

TEST(Pipeline, NumbersFramesThatHaveNoId) {
  ToyStages toys;
  Pipeline pipeline({}, toys.stages());
  auto frames = framesFrom0To(4);
  for (StereoFrame& frame : frames) frame.frame = FrameId{};
  EXPECT_EQ(idsOf(runThrough(pipeline, std::move(frames)).results), numbersTo(4));
}

TEST(Pipeline, DropsOldFramesWhenLiveAndAccountsForAll) {
  constexpr std::int64_t kFrames = 60;
  ToyStages toys{.work = [](Stage stage, FrameId) {
    if (stage == Stage::kMotion) std::this_thread::sleep_for(milliseconds(5));  // five times the camera's period
  }};
  Pipeline pipeline({.policy = InputPolicy::kLive}, toys.stages());
  auto frames = framesFrom0To(kFrames);
  frames[kFrames - 1].problem = "unreadable";  // the last one is never dropped
  const Outcome run = runThrough(pipeline, std::move(frames), milliseconds(1));
  EXPECT_EQ(run.summary.received, kFrames);
  EXPECT_EQ(run.summary.received, run.summary.processed + run.summary.dropped + run.summary.rejected);
  EXPECT_GT(run.summary.dropped, 0);
  EXPECT_EQ(run.summary.rejected, 1);
  EXPECT_EQ(idsOf(run.finals), numbersTo(kFrames));

  std::vector<FrameEstimate> online;
  for (const PipelineResult& result : run.results) {
    for (const FrameEstimate& dropped : result.dropped) {
      EXPECT_EQ(dropped.status, FrameStatus::kDropped);
      EXPECT_EQ(dropped.stamp.ns, dropped.frame.value * kPeriod_ns);
      online.push_back(dropped);
    }
    online.push_back(result.online);
  }
  EXPECT_EQ(idsOf(online), numbersTo(kFrames));
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
    for (int index = 0; index < frames; ++index) EXPECT_TRUE(pipeline.push(frameAt(index)));
  }
}

TEST(Pipeline, KeepsNoImageAliveThroughItsResults) {
  ToyStages toys;
  ImagePool pool;
  Pipeline pipeline({}, toys.stages());
  std::vector<PipelineResult> results;
  for (int index = 0; index < 50; ++index) {
    StereoFrame frame = frameAt(index);
    frame.left = pool.acquire(64, 32);
    ASSERT_TRUE(pipeline.push(std::move(frame)));
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
    EXPECT_GE(timing.of(Stage::kMotion).start, timing.of(Stage::kStereo).end);
    EXPECT_GE(timing.of(Stage::kMotion).start, timing.of(Stage::kFlow).end);
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
