#pragma once

#include <optional>
#include <vector>

#include "core/messages.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/matching/circular_matching.hpp"
#include "frontend/motion/camera_trail.hpp"
#include "frontend/motion/ego_motion.hpp"
#include "frontend/motion/point_tracks.hpp"

namespace motorcade {

/// The camera's motion since the previous frame, measured or predicted.
struct CameraMotion {
  FrameStatus status = FrameStatus::kGood;  // kLost: predicted
  SE3 T_previous_now;
  Matrix6d covariance = Matrix6d::Identity();  // right perturbation of T_previous_now
  int inlier_count = 0;
  std::vector<bool> inliers;  // one per observation: agrees with this motion over a static world
};

/// The camera's motion from frame to frame and the trail that it leaves: ego-motion where enough points agree on it,
/// else the motion of the frame before. Call in frame order, once per frame.
class CameraOdometry {
 public:
  CameraOdometry(const EgoMotionEstimator::Params& params, const StereoCamera& camera) : ego_motion_(params, camera) {}

  /// T_previous_now at the velocity of the frame before; standing still while no motion is known.
  SE3 predict(Timestamp stamp) const;
  bool motionKnown() const { return last_motion_.has_value(); }

  /// Adds a frame to the trail. `known` tells where points were before it, `observed` where they are now; both are
  /// parallel.
  CameraMotion operator()(const StereoFrame& frame, const std::vector<std::optional<KnownPoint>>& known,
                          const std::vector<std::optional<StereoObservation>>& observed);

  const CameraTrail& trail() const { return trail_; }

 private:
  CameraMotion measure(const StereoFrame& frame, const std::vector<std::optional<KnownPoint>>& known,
                       const std::vector<std::optional<StereoObservation>>& observed);

  EgoMotionEstimator ego_motion_;
  CameraTrail trail_;
  std::optional<SE3> last_motion_;  // T_previous_now of the last frame, empty before the second one
  double last_dt_s_ = 0;
  int steady_frames_ = 0;  // see PredictedMotion
};

}  // namespace motorcade
