#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/evaluate/comparison/object_matching.hpp"
#include "apps/evaluate/comparison/trajectory_error.hpp"

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

/// Errors of one label's motion from frame to frame.
struct LabelMotion {
  std::int64_t label = -1;
  std::string type;
  Statistics me_m, me_deg;
};

/// The largest error of one kind, and its frame, label and track.
struct LargestStep {
  double error = 0;  // m or deg
  FrameId frame;
  std::int64_t label = -1;  // none without steps
  TrackId track;
};

/// Errors of the motion of everything that moves and is followed, in the form of published figures (VDO-SLAM, DynoSAM).
/// They are root mean squares over each object's frames, averaged over the objects. Labels count however hidden or
/// small they are, and rows of any state.
struct FollowedMotion {
  std::vector<LabelMotion> objects;  // those with a step at least, by label
  double rms_m = 0, rms_deg = 0;     // the objects' root mean squares, averaged
  Statistics me_m, me_deg;           // over all steps of all objects
  LargestStep largest_m, largest_deg;
};
FollowedMotion followedMotion(const std::vector<ComparedFrame>& frames);

}  // namespace motorcade
