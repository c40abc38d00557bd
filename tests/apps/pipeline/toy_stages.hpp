#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "apps/pipeline/pipeline.hpp"

/// Stages without images, and runs of the pipeline with them.
namespace motorcade {

inline constexpr std::int64_t kPeriod_ns = 100'000'000;

inline StereoFrame frameAt(std::int64_t index) {
  StereoFrame frame;
  frame.head = {.frame = {index}, .stamp = {index * kPeriod_ns}};
  return frame;
}

/// Stages that pass the frame's number on, take as long as `work` says, and move the camera by one meter per
/// frame.
struct ToyStages {
  std::function<void(Stage, FrameId)> work = [](Stage, FrameId) {};
  std::vector<std::int64_t> order_of_flow{}, order_of_motion{}, order_of_backend{};
  double traveled_m = 0;
  std::vector<FrameEstimate> window{};  // keeps two frames
  bool settles = true;                  // the frame before the newest has settled
  FrameId object_from{1000};            // first frame with an object
  int segment = 0;                      // of all frames
  bool branches_met_wrongly = false;

  Stages stages() {
    return {
        .prepare = [this](const StereoFramePtr& m) { return prepare(m); },
        .stereo_matching = [this](const FeaturesPtr& m) { return stereo(m); },
        .optical_flow = [this](const FeaturesPtr& m) { return flow(m); },
        .scene_flow_segmentation = [this](const StereoMatchesPtr& s, const OpticalFlowPtr& f) { return motion(s, f); },
        .tracking = [this](const SceneMotionPtr& m) { return tracking(m); },
        .incremental_optimization = [this](const FrameMeasurementsPtr& m) { return optimize(m); },
        .object_shapes = [this](const ObjectShapes::Inputs& i, const EstimatesPtr& e) { return shape(i.scene, e); },
        .finish = [this] { return std::exchange(window, {}); }};
  }

  EstimatesPtr shape(const SceneMotionPtr& motion, const EstimatesPtr& estimates) {
    work(Stage::kObjectShapes, motion->head.frame);
    Estimates shaped = *estimates;
    for (ObjectEstimate& object : shaped.online.objects) object.existence_probability = 0.75;
    return std::make_shared<const Estimates>(shaped);
  }
  FeaturesPtr prepare(const StereoFramePtr& frame) {
    work(Stage::kPrepare, frame->head.frame);
    Features features;
    features.frame = frame;
    return std::make_shared<const Features>(features);
  }
  StereoMatchesPtr stereo(const FeaturesPtr& features) {
    work(Stage::kStereoMatching, features->frame->head.frame);
    return std::make_shared<const StereoMatches>(StereoMatches{features, {}});
  }
  OpticalFlowPtr flow(const FeaturesPtr& features) {
    work(Stage::kOpticalFlow, features->frame->head.frame);
    order_of_flow.push_back(features->frame->head.frame.value);
    return std::make_shared<const OpticalFlow>(OpticalFlow{features, {}});
  }
  SceneMotionPtr motion(const StereoMatchesPtr& matches, const OpticalFlowPtr& flow) {
    const StereoFrame& frame = *flow->features->frame;
    work(Stage::kSceneFlowSegmentation, frame.head.frame);
    if (matches->features != flow->features) branches_met_wrongly = true;
    order_of_motion.push_back(frame.head.frame.value);
    SceneMotion result;
    result.head = frame.head;
    result.head.segment = segment;
    result.odometry.T_previous_now = SE3(Eigen::Matrix3d::Identity(), {0, 0, order_of_motion.size() > 1 ? 1.0 : 0.0});
    return std::make_shared<const SceneMotion>(result);
  }
  FrameMeasurementsPtr tracking(const SceneMotionPtr& motion) {
    work(Stage::kTracking, motion->head.frame);
    FrameMeasurements result;
    result.head = motion->head;
    result.odometry = motion->odometry;
    return std::make_shared<const FrameMeasurements>(result);
  }
  EstimatesPtr optimize(const FrameMeasurementsPtr& measurements) {
    work(Stage::kIncrementalOptimization, measurements->head.frame);
    order_of_backend.push_back(measurements->head.frame.value);
    traveled_m += measurements->odometry.T_previous_now.translation().z();
    Estimates result;
    result.online.head = measurements->head;
    result.online.T_world_cam = SE3(Eigen::Matrix3d::Identity(), {0, 0, traveled_m});
    if (result.online.head.frame >= object_from) result.online.objects.emplace_back().track = {1};
    window.push_back(result.online);
    if (settles && window.size() > 1) result.settled = {window[window.size() - 2]};
    if (window.size() > 2) {
      result.finals.push_back(window.front());
      window.erase(window.begin());
    }
    return std::make_shared<const Estimates>(result);
  }
};

struct Outcome {
  std::vector<PipelineResult> results;
  std::vector<FrameEstimate> finals, settled;
  PipelineSummary summary;
};

/// Pushes from a second thread, takes results on this one.
inline Outcome runThrough(Pipeline& pipeline, std::vector<StereoFrame> frames,
                          std::chrono::milliseconds period = std::chrono::milliseconds(0)) {
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
    for (const FrameEstimate& estimate : result.settled) run.settled.push_back(estimate);
    run.results.push_back(std::move(result));
  };
  while (auto result = pipeline.next()) keep(std::move(*result));
  PipelineEnd end = pipeline.finish();
  for (PipelineResult& result : end.results) keep(std::move(result));
  for (const FrameEstimate& estimate : end.finals) run.finals.push_back(estimate);
  run.summary = end.summary;
  return run;
}

inline std::vector<StereoFrame> framesFrom0To(std::int64_t count) {
  std::vector<StereoFrame> frames;
  for (std::int64_t index = 0; index < count; ++index) frames.push_back(frameAt(index));
  return frames;
}

inline std::vector<std::int64_t> numbersTo(std::int64_t count) {
  std::vector<std::int64_t> numbers;
  for (std::int64_t index = 0; index < count; ++index) numbers.push_back(index);
  return numbers;
}

inline std::vector<std::int64_t> idsOf(const std::vector<FrameEstimate>& estimates) {
  std::vector<std::int64_t> ids;
  for (const FrameEstimate& estimate : estimates) ids.push_back(estimate.head.frame.value);
  return ids;
}

inline std::vector<std::int64_t> idsOf(const std::vector<PipelineResult>& results) {
  std::vector<std::int64_t> ids;
  for (const PipelineResult& result : results) ids.push_back(result.online.head.frame.value);
  return ids;
}

}  // namespace motorcade
