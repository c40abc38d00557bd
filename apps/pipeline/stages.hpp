#pragma once

#include <functional>
#include <vector>

#include "core/messages.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/shape/object_shapes.hpp"

namespace motorcade {

struct PipelineConfig;

/// The stages that the flow graph wires together. They are functions, so that the graph can be tested with toy stages.
/// `prepare` and `stereo_matching` are called for several frames at once; the others one frame at a time, in order.
/// `finish` is called once, after the last frame. Each call gives one message; a stage that throws costs its frame, not
/// the run.
struct Stages {
  std::function<FeaturesPtr(const StereoFramePtr&)> prepare;
  std::function<StereoMatchesPtr(const FeaturesPtr&)> stereo_matching;
  std::function<OpticalFlowPtr(const FeaturesPtr&)> optical_flow;
  std::function<SceneMotionPtr(const StereoMatchesPtr&, const OpticalFlowPtr&)> scene_flow_segmentation;
  std::function<FrameMeasurementsPtr(const SceneMotionPtr&)> tracking;
  std::function<EstimatesPtr(const FrameMeasurementsPtr&)> incremental_optimization;
  std::function<EstimatesPtr(const ObjectShapes::Inputs&, const EstimatesPtr&)> object_shapes;
  std::function<std::vector<FrameEstimate>()> finish;
};

/// The real stages, for a camera and images of its size. Throws std::invalid_argument on a bad parameter, UsageError
/// where the detector's module is missing.
Stages makeStages(const PipelineConfig& config, const StereoCamera& camera);

}  // namespace motorcade
