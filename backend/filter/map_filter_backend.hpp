#pragma once

#include <memory>

#include "backend/backend.hpp"
#include "backend/filter/object_filter.hpp"

namespace motorcade {

/// Odometry is chained, and every object has its own constant-velocity extended Kalman filter (pose and body twist) on
/// the front-end's poses. These come from a map of the object's points averaged over frames, which the paper's baseline
/// lacks. Frames are final as soon as they are published.
class MapFilterBackend final : public Backend {
 public:
  using Params = ObjectFilter::Params;

  explicit MapFilterBackend(const Params& params, int motion_frames = kCameraCovarianceFrames);
  ~MapFilterBackend() override;

  EstimatesPtr operator()(const FrameMeasurementsPtr& measurements) override;
  std::vector<FrameEstimate> finish() override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace motorcade
