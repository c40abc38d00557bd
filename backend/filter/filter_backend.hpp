#pragma once

#include <memory>

#include "backend/backend.hpp"
#include "backend/filter/object_filter.hpp"

namespace motorcade {

/// The paper's baseline: odometry is chained, and every object has a constant-velocity extended Kalman filter of its
/// own (pose and body twist, on its encounters). Frames are final as soon as they are published.
class FilterBackend final : public Backend {
 public:
  using Params = ObjectFilter::Params;

  explicit FilterBackend(const Params& params);
  ~FilterBackend() override;

  EstimatesPtr operator()(const FrameMeasurementsPtr& measurements) override;
  std::vector<FrameEstimate> finish() override;

  /// Mean normalized innovation squared per dimension, over all objects so far: 1 when the noise is well tuned.
  double meanNormalizedInnovation() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace motorcade
