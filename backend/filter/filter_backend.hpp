#pragma once

#include <memory>
#include <vector>

#include "backend/backend.hpp"
#include "backend/filter/object_filter.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// The paper's baseline: odometry is chained, and every object has its own constant-velocity extended Kalman filter
/// (pose and body twist). The filter corrects by poses chained from the object's motions, each measured from the points
/// that two successive frames show. Nothing is remembered but the state, the chain and the frame before. Frames are
/// final as soon as they are published.
///
/// A chained pose enters with the covariance of its newest link; the filter cannot know that errors of the chain add
/// up. Filtering the links themselves is worse: three times the error of motion on the rendered scenes. A point's
/// measurement of frame i serves two links with opposite signs, so errors cancel in the chain but not in filtered
/// links.
class FilterBackend final : public Backend {
 public:
  using Params = ObjectFilter::Params;

  FilterBackend(const Params& params, const StereoCamera& camera, int motion_frames = kCameraCovarianceFrames);
  ~FilterBackend() override;

  EstimatesPtr operator()(const FrameMeasurementsPtr& measurements) override;
  std::vector<FrameEstimate> finish() override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace motorcade
