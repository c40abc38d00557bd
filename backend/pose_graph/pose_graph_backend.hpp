#pragma once

#include "backend/pose_graph/object_measurer.hpp"
#include "backend/pose_graph/pose_graph_params.hpp"
#include "backend/window/window_backend.hpp"

namespace motorcade {

/// The paper's graph of poses, from encounters and motions as they come. An object that the system cannot determine is
/// dropped, and the camera goes on.
class PoseGraphSmoother final : public WindowBackend {
 public:
  explicit PoseGraphSmoother(const PoseGraphParams& params, const WindowParams& window = {});
};

/// The same graph from points: encounters and motions are measured two frames at a time and then smoothed.
class PoseGraphBackend final : public Backend {
 public:
  using Params = PoseGraphParams;

  PoseGraphBackend(const Params& params, const StereoCamera& camera, const WindowParams& window = {})
      : measurer_(camera), smoother_(params, window) {}

  EstimatesPtr operator()(const FrameMeasurementsPtr& measurements) override {
    return smoother_(std::make_shared<const FrameMeasurements>(measurer_(*measurements)));
  }
  std::vector<FrameEstimate> finish() override { return smoother_.finish(); }

 private:
  ObjectMeasurer measurer_;
  PoseGraphSmoother smoother_;
};

}  // namespace motorcade
