#pragma once

#include "backend/joint/joint_params.hpp"
#include "backend/window/window_backend.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// Camera, objects and points in one estimate: bundle adjustment in body frames, solved incrementally.
class JointBackend final : public WindowBackend {
 public:
  using Params = JointParams;

  JointBackend(const Params& params, const StereoCamera& camera, const WindowParams& window = {});
};

}  // namespace motorcade
