#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/parameters.hpp"
#include "core/se3.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/geometry/stereo_pose.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// Camera motion between two frames from points that were triangulated before and are seen now.
struct EgoMotion {
  SE3 T_seen_now;
  Matrix6d covariance;        // right perturbation of T_seen_now
  std::vector<bool> inliers;  // one per observation
  int inlier_count = 0;
};

/// Motion of the camera as the frames before predict it.
struct PredictedMotion {
  SE3 T_seen_now;
  double dt_s = 0;        // from the previous frame to now
  int steady_frames = 0;  // in a row that moved as the frame before them did; 0: no motion is known
  int ahead_frames = 0;   // that the camera drove ahead over the road, as on a car, and none in which it slid
  /// The axes of motions ahead and aside, see levelAxes.
  Eigen::Matrix3d R_cam_level = Eigen::Matrix3d::Identity();
  /// Covariance of T_seen_now by the vehicle's own sensors, right perturbation; empty where the motion before is taken
  /// to go on.
  std::optional<Matrix6d> by_vehicle{};
  /// The camera stood when it was seen last, a few seconds ago. Few points do not tell that it started since.
  bool stood = false;
};

/// A motion in other axes of the camera.
SE3 inAxes(const Eigen::Matrix3d& R_cam_axes, const SE3& T_seen_now);
/// True when a camera that moves like this goes ahead, along z of level axes, at the speed of a car.
bool drivesAhead(const SE3& T_seen_now, double dt_s);
/// True when it goes sideways or upwards, beyond bumps and the chord of a curve, or turns where it stands; in level
/// axes.
bool slides(const SE3& T_seen_now, double dt_s);

/// RANSAC over three points, then covariance-weighted refinement over all inliers. Stateless.
class EgoMotionEstimator {
 public:
  struct Params {
    int max_hypotheses = 80;
    double inlier_chi2 = 12.0;  // 3 degrees of freedom: 99 % is 11.3
    int min_inliers = 12;
    double max_acceleration_mps2 = 20;  // of the camera, jitter of its times included
  };
  EgoMotionEstimator(const Params& params, const StereoCamera& camera)
      : params_(requireValid(params)), camera_(camera) {}

  /// Measures a motion; `observations` hold points in the previous camera's frame, `labels` what they were in the one
  /// before it. The predicted motion is scored first, and what a vehicle cannot do after it must win by more. Random
  /// samples are drawn from a generator seeded with `seed` (the frame number). Empty when too few points agree on any
  /// motion.
  std::optional<EgoMotion> operator()(std::span<const PoseObservation> observations,
                                      const std::vector<PointLabel>& labels, const PredictedMotion& predicted,
                                      std::uint64_t seed) const;

  /// True when a vehicle can have moved like this after what was predicted.
  bool follows(const SE3& T_now_seen, const PredictedMotion& predicted) const {
    return surprise(T_now_seen, predicted) < 1;
  }
  /// True when a steady motion went on in a way that no vehicle can.
  bool breaks(const SE3& T_now_seen, const PredictedMotion& predicted) const;

 private:
  double surprise(const SE3& T_now_seen, const PredictedMotion& predicted) const;
  static double penaltyOf(const PredictedMotion& predicted);
  /// True for a sliding motion of a car's camera, which has driven ahead all the time and cannot slide. Then the points
  /// move, as when a truck fills the view.
  static bool isBeyondBelief(const SE3& T_now_seen, const PredictedMotion& predicted);
  SE3 bestHypothesis(std::span<const PoseObservation> observations, const std::vector<PointLabel>& labels,
                     const PredictedMotion& predicted, std::uint64_t seed) const;
  std::optional<PoseFit> refine(std::span<const PoseObservation> observations, const PoseObservations& all,
                                const SE3& hypothesis) const;

  Params params_;
  StereoCamera camera_;
};

std::vector<Parameter> parametersOf(EgoMotionEstimator::Params& params);

}  // namespace motorcade
