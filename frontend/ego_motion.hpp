#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/se3.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/stereo_pose.hpp"

namespace motorcade {

/// The camera's motion between two frames from points that were triangulated before and are seen now.
struct EgoMotion {
  SE3 T_previous_now;
  Matrix6d covariance;        // right perturbation of T_previous_now
  std::vector<bool> inliers;  // one per observation
  int inlier_count = 0;
};

/// What is known of a point before the camera's motion is.
enum class EgoHint : std::uint8_t {
  kNone,
  kMoved,   // moved in the previous frame
  kGround,  // lay on the road: its vote breaks the tie where vehicles fill the view
};

/// RANSAC over three points, then covariance-weighted refinement over all inliers. Stateless.
class EgoMotionEstimator {
 public:
  struct Params {
    int max_hypotheses = 80;
    int scored_points = 300;    // per hypothesis, spread evenly over the observations
    double inlier_chi2 = 12.0;  // 3 degrees of freedom: 99 % is 11.3
    int min_inliers = 12;
    double known_mover_weight = 0.1;  // vote of a point that moved in the previous frame
    double ground_weight = 4;         // and of one on the road
    PoseFitParams fit;
  };
  EgoMotionEstimator(const Params& params, const StereoCamera& camera) : params_(params), camera_(camera) {}

  /// `observations` hold points in the previous camera's frame, `hints` what is known of each.
  /// The predicted motion is scored first; random samples are drawn from a generator seeded with `seed` (the frame number).
  /// Empty when too few points agree on any motion.
  std::optional<EgoMotion> operator()(std::span<const PoseObservation> observations, std::span<const EgoHint> hints,
                                      const SE3& predicted_T_previous_now, std::uint64_t seed) const;

 private:
  double weightOf(EgoHint hint) const;
  SE3 bestHypothesis(std::span<const PoseObservation> observations, std::span<const EgoHint> hints, const SE3& predicted_T_now_previous,
                     std::uint64_t seed) const;

  Params params_;
  StereoCamera camera_;
};

}  // namespace motorcade
