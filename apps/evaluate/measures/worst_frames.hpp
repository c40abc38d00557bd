#pragma once

#include <cstdint>
#include <vector>

#include "apps/evaluate/comparison/object_matching.hpp"

namespace motorcade {

/// Error of the camera's step from the previous frame.
struct CameraFrameError {
  FrameId frame;
  double rpe_t_m = 0, rpe_r_deg = 0;
};

/// The error of an object's motion from the frame before.
struct ObjectFrameError {
  FrameId frame;
  std::int64_t label = -1;
  TrackId track;
  double me_t_m = 0;
};

/// The frames with the largest translation errors, the largest first. They are the first to look at.
struct WorstFrames {
  std::vector<CameraFrameError> camera;
  std::vector<ObjectFrameError> objects;
};
WorstFrames worstFrames(const std::vector<ComparedFrame>& frames, std::size_t most = 10);

}  // namespace motorcade
