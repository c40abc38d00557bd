#pragma once

#include <memory>
#include <vector>

#include "backend/backend.hpp"
#include "backend/filter/object_filter.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// The paper's baseline: odometry is chained, and every object has a constant-velocity extended Kalman filter of its
/// own (pose and body twist) on poses that are chained from its motions from frame to frame, each measured from the
/// points that both frames show. Nothing is remembered but the state, the chain and the frame before. Frames are final
/// as soon as they are published.
///
/// A chained pose is taken with the covariance of its newest link: what came in before it moves the pose for good. That
/// its errors add up the filter cannot know. Filtering the links themselves is worse: a point's measurement of frame i
/// serves two links, into i and out of it, with opposite signs, so that errors cancel in the chain but not in filtered
/// links (three times the error of motion on the rendered scenes).
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
