#pragma once

#include <memory>
#include <vector>

#include "backend/backend.hpp"
#include "backend/smoother/object_measurer.hpp"
#include "backend/smoother/optimizer.hpp"

namespace motorcade {

/// The paper's graph of poses from observations of points: encounters and motions are measured two frames at a time and
/// then smoothed.
class PoseGraphBackend final : public Backend {
 public:
  using Params = SmootherParams;

  PoseGraphBackend(const Params& params, const StereoCamera& camera) : measurer_(camera), optimizer_(params) {}

  EstimatesPtr operator()(const FrameMeasurementsPtr& measurements) override {
    return optimizer_(std::make_shared<const FrameMeasurements>(measurer_(*measurements)));
  }
  std::vector<FrameEstimate> finish() override { return optimizer_.finish(); }

 private:
  ObjectMeasurer measurer_;
  Optimizer optimizer_;
};

}  // namespace motorcade
