#pragma once

#include <map>

#include "backend/joint/joint_params.hpp"
#include "backend/window/smoothing_window.hpp"

namespace motorcade {

/// Motion of objects from frame to frame, as factors on their poses c seen from the camera and their twists w. The
/// twist is constant but for white noise on acceleration, and bodies roll along the axes of travel, which are the
/// variable that all frames of an object share.
class ObjectChain {
 public:
  /// `frames` are those of the window.
  ObjectChain(const JointParams& params, bool use_smoothness, IncrementalSolver& solver,
              const std::map<FrameId, CameraRecord>& frames)
      : params_(params), use_smoothness_(use_smoothness), solver_(solver), frames_(frames) {}

  /// Adds the track's first pose.
  void begin(ObjectTrack& track, ObjectRecord& record);
  /// Adds a further pose: where it was seen while the track has no gauge yet, then where the motion of the record
  /// before puts it.
  void extend(const ObjectTrack& track, const ObjectRecord& before, ObjectRecord& record);
  /// Chooses the gauge of the body's frame: the oldest pose from which on all records have measured points of the body.
  /// Those before it were found by looking back, and may be far off.
  void hold(ObjectTrack& track);
  /// Renews an object's motion from the camera's, which is known better when its landmarks have ended.
  void renewMotion(ObjectTrack& track, FrameId newest);

  /// Axes of travel in those of the body's variables.
  Eigen::Matrix3d travelAxes(const ObjectTrack& track) const;

 private:
  SE3 cameraMotion(const ObjectRecord& before, const ObjectRecord& now) const;
  void addMotion(const ObjectTrack& track, const ObjectRecord& before, ObjectRecord& now);
  void addRolling(const ObjectTrack& track, const ObjectRecord& record);

  const JointParams& params_;
  bool use_smoothness_;
  IncrementalSolver& solver_;
  const std::map<FrameId, CameraRecord>& frames_;
};

}  // namespace motorcade
