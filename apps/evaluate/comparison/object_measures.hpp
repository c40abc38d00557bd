#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/evaluate/comparison/object_matching.hpp"
#include "apps/evaluate/comparison/object_positions.hpp"
#include "apps/evaluate/comparison/trajectory_error.hpp"

/// Detection, following and accuracy of objects, over labels that are counted and move.
namespace motorcade {

/// E = L(k)^-1 H L(k-1) of one frame k: H the estimated motion, L the label's poses, in the true camera.
struct ObjectStepError {
  FrameId frame;
  std::int64_t label = -1;
  TrackId track;
  SE3 error;
};
/// Step errors of each track on its label, where both frames have a pair. `pairs` are in the order of the frames.
std::vector<ObjectStepError> objectStepErrors(const std::vector<AskedPair>& pairs);

/// Motion of objects from frame to frame, and speed.
struct MotionErrors {
  Statistics me_m, me_deg;  // of the step errors
  Statistics speed_mps;     // |estimated| - |true|
  double speed_bias_mps = 0;
  double speed_coverage = 0;  // share of speeds within 1.96 of their sigma
};

/// One label's trajectory, from the longest of the tracks that followed it.
struct ObjectErrors {
  std::int64_t label = -1;
  std::string type;
  TrackId track;
  int labeled_frames = 0;   // counted and moving
  int followed_frames = 0;  // by any track
  int tracks = 0;
  /// Path of the body's origin, SE(3) aligned; "first pose" aligns by the body frame at the first match.
  std::optional<TrajectoryErrors> trajectory;
  std::optional<PositionErrors> positions;
  MotionErrors motion;
};

struct DetectionCounts {
  int labels = 0, found = 0;
  double recall() const { return labels > 0 ? static_cast<double>(found) / labels : 0; }
};

struct DetectionErrors {
  DetectionCounts within_30m, from_30_to_50m;
  DetectionCounts within_30m_from_fifth, from_30_to_50m_from_fifth;  // from the label's fifth visible frame on
  int rows = 0, false_rows = 0;
  int false_rows_unlabeled = 0;   // on no label
  int false_rows_in_ignored = 0;  // of these, mostly in an area that the labels leave open
  int id_switches = 0;
  double mota = 0;
  /// Frames of the false rows by track, and of the labels within 30 m that were not found by label.
  std::map<std::int64_t, std::vector<std::int64_t>> false_in, missed_in;
};

MotionErrors motionErrors(const std::vector<ComparedFrame>& frames, std::optional<std::int64_t> label = {});
std::vector<ObjectErrors> objectErrors(const std::vector<ComparedFrame>& frames);
DetectionErrors detectionErrors(const std::vector<ComparedFrame>& frames);

}  // namespace motorcade
