#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/messages.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/matching/circular_matching.hpp"
#include "frontend/motion/camera_mounting.hpp"
#include "frontend/motion/camera_trail.hpp"
#include "frontend/motion/ego_motion.hpp"
#include "frontend/motion/point_tracks.hpp"
#include "frontend/motion/vehicle_odometry.hpp"

namespace motorcade {

/// The camera's motion since the last frame that was seen, measured or predicted.
struct CameraMotion {
  FrameStatus status = FrameStatus::kGood;  // kLost: predicted
  FrameCause cause = FrameCause::kNone;
  SE3 T_seen_now;
  Matrix6d covariance = Matrix6d::Identity();  // right perturbation of T_seen_now
  int inlier_count = 0, measured_count = 0;    // of so many points that were known before
  bool disputed = false;                       // most points agree on one that the vehicle's sensors contradict
  std::vector<bool> inliers;                   // one per observation: agrees with this motion over a static world
};

/// The camera's motion from frame to frame and the trail that it leaves: ego-motion where enough points agree on it,
/// else the motion measured last. Frames in which nothing is seen leave no trail: motion is measured from the last one
/// that was seen. Call in frame order, once per frame.
class CameraOdometry {
 public:
  CameraOdometry(const EgoMotionEstimator::Params& params, const StereoCamera& camera) : ego_motion_(params, camera) {}

  /// Takes the inputs that come with the next frame.
  void hear(const FrameInputs& inputs, Timestamp frame) { vehicle_.hear(inputs, frame); }
  /// Predicts the motion since the last frame that was seen: by the vehicle's own sensors, else at the velocity
  /// measured last, or standing still while none is known.
  PredictedMotion predict(Timestamp stamp) const;
  /// Takes the camera's mounting over the road: a car goes ahead and turns over it, wherever its camera looks.
  void levelBy(const GroundPlane& mounting) { R_cam_level_ = levelAxes(mounting.normal_cam); }
  /// True when sensors tell the motion, or it was measured not too long ago.
  bool motionKnown(Timestamp stamp) const;

  /// True when the camera may have moved like this since the last frame that was seen.
  bool believes(const SE3& T_seen_now, const PredictedMotion& predicted) const {
    return !ego_motion_.breaks(T_seen_now.inverse(), predicted);
  }
  /// Measures the motion since the last frame that was seen. `known` tells where points were then, `observed` where
  /// they are now; both are parallel. The first frame that is seen does not move.
  CameraMotion measure(const StereoFrame& frame, const std::vector<std::optional<KnownPoint>>& known,
                       const std::vector<std::optional<StereoObservation>>& observed,
                       const PredictedMotion& predicted) const;
  /// Adds a frame with its measured motion to the trail. Returns the motion since the frame before, seen or not.
  Odometry add(Timestamp stamp, const CameraMotion& motion);
  /// Adds a frame in which nothing is seen, whose motion is predicted.
  Odometry passOver(Timestamp stamp);

  const CameraTrail& trail() const { return trail_; }
  /// Findings about the vehicle's sensors; empty where there are none.
  std::optional<VehicleSensors> vehicleSensors() const { return vehicle_.sensors(); }
  /// Speed as last measured; 0 while it is not known.
  double speed_mps() const { return last_motion_ ? last_motion_->translation().norm() / last_dt_s_ : 0; }
  /// Segment of the last frame, see FrameHead.
  int segment() const { return segment_; }

 private:
  /// A motion since the last frame that was seen, without the images: see Odometry::Told.
  using Told = std::optional<UncertainMotion>;
  double sinceSeen_s(Timestamp stamp) const;
  PredictedMotion predictedByCamera(Timestamp stamp) const;
  Timestamp toldSince(Timestamp stamp) const;
  SE3 levelMotion() const;
  Vector6d withheld(Timestamp stamp) const;
  UncertainMotion drivenOn(const SE3& motion, double ahead_m2, double yaw_rad2) const;
  Told standing(Timestamp stamp) const;
  Told steady(Timestamp stamp) const;
  Odometry stepTo(Timestamp stamp, const SE3& T_seen_now, const Matrix6d& covariance, const Told& told);
  std::optional<EgoMotion> againstVehicle(std::span<const PoseObservation> observations,
                                          const std::vector<PointLabel>& labels, const FrameHead& head) const;
  void rememberMotion(Timestamp stamp, const CameraMotion& motion);

  EgoMotionEstimator ego_motion_;
  VehicleOdometry vehicle_;
  Eigen::Matrix3d R_cam_level_ = Eigen::Matrix3d::Identity();
  CameraTrail trail_;  // of frames that were seen
  int segment_ = 0;
  bool unlinked_ = false;                 // since the last frame that was good
  SE3 T_seen_before_;                     // from the last one to the last frame, seen or not
  Told told_before_;                      // the same without the images, while frames are not seen
  std::optional<Timestamp> first_stamp_;  // of the first frame, seen or not
  std::optional<Timestamp> last_stamp_;   // of the last frame, seen or not
  std::optional<SE3> last_motion_;        // as last measured, from frame to frame
  double last_dt_s_ = 0;
  double yaw_rate_radps_ = 0, turn_radps_ = 0;  // of the last motion, and the part of it that the one before had, too
  Timestamp measured_at_;
  int steady_frames_ = 0, ahead_frames_ = 0;  // see PredictedMotion
  int standing_frames_ = 0;                   // in a row; degraded ones in which it seems to move are passed over
  Timestamp stood_until_;                     // the last one of these
};

}  // namespace motorcade
