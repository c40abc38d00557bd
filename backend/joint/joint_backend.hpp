#pragma once

#include <memory>
#include <vector>

#include "backend/backend.hpp"
#include "backend/joint/joint_params.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// Camera, objects and points in one estimate: bundle adjustment in body frames, solved incrementally.
class JointBackend final : public Backend {
 public:
  using Params = JointParams;

  JointBackend(const Params& params, const StereoCamera& camera);
  ~JointBackend() override;

  EstimatesPtr operator()(const FrameMeasurementsPtr& measurements) override;
  std::vector<FrameEstimate> finish() override;

 private:
  class Estimator;
  std::unique_ptr<Estimator> estimator_;
};

}  // namespace motorcade
