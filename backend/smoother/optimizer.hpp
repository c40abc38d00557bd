#pragma once

#include <memory>
#include <vector>

#include "backend/backend.hpp"
#include "backend/smoother/smoother_params.hpp"

namespace motorcade {

/// The smoother: one pose graph for the camera and one per object, joined by anchors (Kim et al. 2010), solved
/// incrementally. An object that the system cannot determine is dropped, and the camera goes on.
class Optimizer final : public Backend {
 public:
  using Params = SmootherParams;

  explicit Optimizer(const Params& params);
  ~Optimizer() override;

  EstimatesPtr operator()(const FrameMeasurementsPtr& measurements) override;
  std::vector<FrameEstimate> finish() override;

 private:
  class Smoother;
  std::unique_ptr<Smoother> smoother_;
};

}  // namespace motorcade
