#include "apps/pipeline/stage_runner.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <utility>

#include <oneapi/tbb/task_arena.h>

#include "core/thread_placement.hpp"
#include "core/unknown_motion.hpp"

namespace motorcade {
namespace {

template <class Message>
std::shared_ptr<const Message> shared(Message message) {
  return std::make_shared<const Message>(std::move(message));
}

/// Head of a frame that is lost, as a stage failed on which its pose depends.
FrameHead lost(FrameHead head) {
  head.status = FrameStatus::kLost;
  head.cause = FrameCause::kFailed;
  return head;
}

/// Calls `work` and returns its exception in words, empty for none.
template <class Work>
std::string exceptionOf(const Work& work) {
  try {
    work();
  } catch (const std::exception& error) {
    return error.what();
  } catch (...) {
    return "unknown exception";
  }
  return {};
}

void nameProblem(Job& job, Stage stage, const std::string& problem) {
  try {
    job.problemOf(stage) = nameOf(stage) + " failed: " + problem;
  } catch (const std::bad_alloc&) {
    job.problemOf(stage) = kNoMemoryLeft;
  }
}

// Messages that replace those of a stage that threw. They equal the stage's messages for a frame without images or
// without an ego-motion, so that later stages meet nothing new.

/// The camera's motion without objects.
FrameMeasurementsPtr cameraAlone(const SceneMotion& motion) {
  FrameMeasurements camera;
  camera.head = motion.head.status == FrameStatus::kGood ? lost(motion.head) : motion.head;
  camera.odometry = motion.odometry;
  return shared(std::move(camera));
}

/// Estimates without a pose. The publisher knows the last pose, and predicts.
EstimatesPtr lostEstimates(const FrameMeasurements& measurements) {
  Estimates estimates;
  estimates.online.head = lost(measurements.head);
  return shared(std::move(estimates));
}

OpticalFlowPtr noFlow(const FeaturesPtr& features) {
  return shared(OpticalFlow{.features = features, .observations = {}});
}

StereoMatchesPtr noMatches(const FeaturesPtr& features) {
  StereoMatches none{.features = features, .of_corner = {}};
  none.of_corner.resize(features->corners.size());
  return shared(std::move(none));
}

/// No points and no components; the camera moves as in the frame before, in the same segment.
SceneMotionPtr predictedMotion(const StereoFrame& frame, const SceneMotion& before) {
  SceneMotion predicted;
  predicted.head = frame.rejected() ? frame.head : lost(frame.head);
  predicted.head.segment = before.head.segment;
  predicted.odometry = {before.odometry.T_previous_now, unknownMotionCovariance()};
  return shared(std::move(predicted));
}

/// The estimates without shapes. Objects keep the probability of existence that is known of them; others are dropped,
/// because only the shapes tell whether they are there.
EstimatesPtr withoutShapes(const Estimates& estimates, const KnownExistence& known) {
  Estimates without = estimates;
  const auto keepKnown = [&](FrameEstimate& frame) {
    std::erase_if(frame.objects, [&](const ObjectEstimate& object) { return !known.contains(object.track); });
    for (ObjectEstimate& object : frame.objects) object.existence_probability = known.at(object.track);
  };
  keepKnown(without.online);
  std::ranges::for_each(without.settled, keepKnown);
  std::ranges::for_each(without.finals, keepKnown);
  return shared(std::move(without));
}

/// Adds the newest frame's objects to `known`, which keeps the youngest thousand tracks.
void rememberExistence(const FrameEstimate& frame, KnownExistence& known) {
  constexpr std::size_t kMostTracks = 1000;
  for (const ObjectEstimate& object : frame.objects) known[object.track] = object.existence_probability;
  while (known.size() > kMostTracks) known.erase(known.begin());
}

/// The frame without its images, rejected for `problem`.
FeaturesPtr rejectedFeatures(const StereoFrame& frame, const std::string& problem) {
  StereoFrame rejected;
  rejected.head = frame.head;
  rejected.due = frame.due;
  rejected.reject(FrameCause::kFailed, problem);
  Features features;
  features.frame = shared(std::move(rejected));
  return shared(std::move(features));
}

}  // namespace

StageRunner::StageRunner(Stages stages, LogCallback log) : stages_(std::move(stages)), log_(std::move(log)) {}

/// Runs a stage in isolation: while it waits for its own parallel loop it must not begin with a later frame.
template <class Run, class Fallback>
auto StageRunner::attempt(Job& job, Stage stage, const Run& run, const Fallback& fallback) {
  StageSpan& span = job.timing.of(stage);
  decltype(run()) message;
  span.worker = oneapi::tbb::this_task_arena::current_thread_index();
  span.start = std::chrono::steady_clock::now();
  const double cpu_before_ms = threadCpu_ms();
  const std::string problem = exceptionOf([&] {
    oneapi::tbb::this_task_arena::isolate([&] { message = run(); });
    if (!message) throw std::logic_error("no message came out");
  });
  if (!problem.empty()) {
    nameProblem(job, stage, problem);
    tell(log_, LogLevel::kError, [&] { return job.name() + ": " + job.problemOf(stage); });
    message = fallback();
  }
  span.cpu_ms = threadCpu_ms() - cpu_before_ms;
  span.end = std::chrono::steady_clock::now();
  return message;
}

void StageRunner::prepare(Job& job) {
  job.features = attempt(
      job, Stage::kPrepare, [&] { return stages_.prepare(job.frame); },
      [&] { return rejectedFeatures(*job.frame, job.problemOf(Stage::kPrepare)); });
}

void StageRunner::matchStereo(Job& job) {
  job.matches = attempt(
      job, Stage::kStereoMatching, [&] { return stages_.stereo_matching(job.features); },
      [&] { return noMatches(job.features); });
}

void StageRunner::trackFlow(Job& job) {
  job.flow = attempt(
      job, Stage::kOpticalFlow, [&] { return stages_.optical_flow(job.features); },
      [&] { return noFlow(job.features); });
}

void StageRunner::segmentSceneFlow(Job& job) {
  job.motion = attempt(
      job, Stage::kSceneFlowSegmentation, [&] { return stages_.scene_flow_segmentation(job.matches, job.flow); },
      [&] { return predictedMotion(*job.features->frame, *last_motion_); });
  last_motion_ = job.motion;
}

void StageRunner::trackObjects(Job& job) {
  job.measurements = attempt(
      job, Stage::kTracking, [&] { return stages_.tracking(job.motion); }, [&] { return cameraAlone(*job.motion); });
}

void StageRunner::optimize(Job& job) {
  job.estimates = attempt(
      job, Stage::kIncrementalOptimization, [&] { return stages_.incremental_optimization(job.measurements); },
      [&] { return lostEstimates(*job.measurements); });
  for (const std::string& problem : job.estimates->problems)
    tell(log_, LogLevel::kWarning, [&] { return job.name() + ": " + problem; });
}

void StageRunner::shapeObjects(Job& job) {
  job.estimates = attempt(
      job, Stage::kObjectShapes,
      [&] {
        return stages_.object_shapes({job.features, job.motion, job.measurements}, job.estimates);
      },
      [&] { return withoutShapes(*job.estimates, existence_); });
  rememberExistence(job.estimates->online, existence_);
}

std::vector<FrameEstimate> StageRunner::finish() {
  std::vector<FrameEstimate> finals;
  const std::string problem = exceptionOf([&] { finals = stages_.finish(); });
  if (!problem.empty()) tell(log_, LogLevel::kError, [&] { return "the back-end could not finish: " + problem; });
  return finals;
}

}  // namespace motorcade
