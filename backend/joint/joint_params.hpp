#pragma once

#include <vector>

#include "backend/factors/twist_factors.hpp"
#include "backend/joint/body_points.hpp"
#include "backend/joint/landmark.hpp"
#include "core/constant_twist.hpp"
#include "core/parameters.hpp"

namespace motorcade {

/// Parameters of the joint estimate of camera, objects and points.
struct JointParams {
  /// Views of a landmark, after which its track is cut.
  int track_frames = 10, object_track_frames = 14;
  /// Age up to which a cut leaves views, see BodyPoints. Vehicles have few points, and each point that is followed for
  /// long keeps the body's frame where it is.
  int object_kept_frames = 64;
  int max_static_landmarks = 400, max_object_landmarks = 30;  // followed at a time, of each object
  /// The landmarks at rest are eliminated in one of so many frames; the camera is aligned to them in the others.
  int frames_per_elimination = 2;
  int frames_per_factor = 5;  // tracks that ended in so many frames share a factor
  int point_half = 0;         // 1 and 2 use the points with odd and even ids only, to compare both; 0 uses all

  /// Noise of landmarks' observations. Texture is matched with about the same bias in each frame, so all disparities of
  /// a landmark share an error. Points at rest are seen at the slanted edges of all kinds of things, and through a
  /// calibration that is not exact. The bias of a vehicle's points is measured as half to .8 of the noise of one
  /// disparity, whether that is .04 or .3 px. Variances of landmarks at rest may differ less: with 4 degrees of freedom
  /// the camera's path is hardly more exact, but its covariances claim it.
  LandmarkNoise static_noise{.variance_freedom = 8, .shared_disparity_sigma_px = 0.5};
  LandmarkNoise object_noise{.shared_disparity_sigma_px = 0, .shared_disparity_share = 0.7};
  double shake_sigma_px = 0.03;  // of the cameras against each other, before it is seen; 0: they never shake
  double offset_sigma_px = 1.0;  // prior of the disparity offset of a rig that is found to be off; 0 trusts every rig

  double first_pose_sigma_m = 1e-3, first_pose_sigma_rad = 1e-4;
  /// Gauge of an object: the oldest pose of its unbroken run of measured frames, see ObjectChain::hold.
  double object_origin_sigma_m = 1e-3, object_axes_sigma_rad = 1e-4;
  /// Prior of an object's first twist: a vehicle may be fast, but hardly turns.
  double twist_sigma_mps = 20, yaw_rate_sigma_radps = 0.2, tilt_rate_sigma_radps = 0.05;
  /// Prior of how the object travels in that frame.
  double lever_sigma_m = 2, travel_yaw_sigma_rad = 0.1, travel_pitch_sigma_rad = 0.03;

  AccelerationNoise acceleration{
      .along_mps2 = 0.7, .sideways_mps2 = 0.3, .vertical_mps2 = 0.1, .yaw_radps2 = 0.05, .tilt_radps2 = 0.01};
  RollingNoise rolling;

  /// See IncrementalSolver::Params.
  double mismatch_tolerance = 0.05, jacobian_drift_sigmas = 0.5, substitution_tolerance = 0.05;
  /// Scalars substituted beyond the changed cliques, see IncrementalSolver. Each frame tells a little more of an
  /// object's axes along its travel, and with them its whole path turns.
  int spread_scalars = 50;
  int relinearized_scalars = 300;  // the budget where none is set: with more of it, nothing becomes more exact
  int iterations_per_update = 1;
  int final_iterations =
      1;  // when the drive has ended: the updates leave little to do, a second one nothing that shows
};

std::vector<Parameter> parametersOf(JointParams& params);

/// Parameters by which landmarks of a body are chosen in this camera's images.
BodyPoints::Params pointParams(const JointParams& params, const StereoCamera& camera, int max_views, int max_landmarks);

}  // namespace motorcade
