#pragma once

#include <deque>
#include <optional>

#include "core/stereo_camera.hpp"
#include "core/timestamp.hpp"
#include "frontend/messages.hpp"
#include "frontend/tracking/object_motion.hpp"
#include "frontend/tracking/tracked_object.hpp"

namespace motorcade {

/// Looks for an object in the frames before it was spawned. Its points were followed for some frames by then, and tell
/// where it was.
class LookBack {
 public:
  /// Looks back `frames` frames at most before an object was spawned. It is looked for in all of them if it is
  /// confirmed up to `confirmed_after` + `kLateFrames` frames after that.
  LookBack(int frames, int confirmed_after, const ObjectMotionEstimator::Params& params, const StereoCamera& camera)
      : frames_(frames), kept_(frames + confirmed_after + kLateFrames), motion_(params, camera) {}

  /// Puts the observations found before the object's backlog. It ends at the first frame in which the object is not
  /// found, or in which another object was reported where it is.
  void operator()(TrackedObject& object, Timestamp now, const ObjectKinematics::Params& kinematics) const;

  /// Forgets the past frames, as no motion links the next ones to them.
  void forget() { past_.clear(); }
  /// Call at the end of each frame, with the observations that it reported, and their objects.
  void remember(const SceneMotionPtr& scene, const SE3& T_world_cam, const std::vector<ObjectObservation>& reported,
                const std::vector<TrackedObject>& objects);

  struct Body {
    SE3 T_cam_body;
    Eigen::AlignedBox3d core;  // around its points, in its frame
  };
  struct PastScene {
    SceneMotionPtr scene;
    SE3 T_world_cam;
    std::vector<Body> reported;
  };
  /// The frames that are remembered, oldest first.
  const std::deque<PastScene>& past() const { return past_; }

 private:
  std::optional<ObjectObservation> observe(const PastScene& earlier, const TrackedObject& followed,
                                           TrackedObject& object, ObjectKinematics& then, MeasuredPoints& later) const;

  static bool isTaken(const PastScene& scene, const SE3& T_cam_body, bool small);

  static constexpr int kLateFrames = 4;  // each keeps the images of one more pair

  int frames_, kept_;
  ObjectMotionEstimator motion_;
  std::deque<PastScene> past_;
};

}  // namespace motorcade
