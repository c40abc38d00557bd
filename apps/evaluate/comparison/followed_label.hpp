#pragma once

#include <cstdint>
#include <vector>

#include "apps/evaluate/comparison/object_matching.hpp"

namespace motorcade {

/// A label as one track followed it: the frames in which the label is asked for and the track's row is reported.
struct FollowedLabel {
  struct Frame {
    FrameId frame;
    SE3 T_world_body, T_world_label;  // the world of the run: its first camera
    SE3 T_cam_body, T_cam_label;      // the body from the estimated camera, the label from the true one
    double range_m() const;           // of the label, on the ground
  };
  std::int64_t label = -1;
  TrackId track;
  std::vector<Frame> frames;
};

/// Ordered by label, then track.
std::vector<FollowedLabel> followedLabels(const std::vector<ComparedFrame>& frames);

}  // namespace motorcade
