#pragma once

#include <vector>

#include "backend/joint/twist_factors.hpp"
#include "core/constant_twist.hpp"
#include "core/parameters.hpp"

namespace motorcade {

/// Parameters of the joint estimate of camera, objects and points.
struct JointParams {
  int window_frames = 1000;  // a frame is final when it leaves the window; 0 keeps everything

  int track_frames = 10;           // views of a landmark's track
  int max_static_landmarks = 500;  // followed at a time
  int max_object_landmarks = 60;   // of each object

  /// Of an error that all disparities of a landmark share, as its texture is matched with the same bias in each frame.
  double static_disparity_sigma_px = 0.3, object_disparity_sigma_px = 0.1;
  double max_offset_px = 1.0;  // standard deviation of the disparity offset of a rig that is not calibrated; 0 trusts it


  /// Whether objects' points, and the way vehicles move, are used.
  bool use_objects = true, use_smoothness = true, use_rolling = true;

  double first_pose_sigma_m = 1e-3, first_pose_sigma_rad = 1e-4;
  /// Gauge of an object: its frame at birth; the axes may turn a little, until they lie along the travel.
  double object_origin_sigma_m = 1e-3, object_axes_sigma_rad = 0.1;
  double twist_sigma_mps = 20, twist_sigma_radps = 1;  // of an object's first twist
  double lever_sigma_m = 2;

  AccelerationNoise acceleration{
      .along_mps2 = 1.5, .sideways_mps2 = 0.3, .vertical_mps2 = 0.2, .yaw_radps2 = 0.07, .tilt_radps2 = 0.02};
  RollingNoise rolling;

  double mismatch_tolerance = 0.05, jacobian_drift_sigmas = 0.5, substitution_tolerance = 0.05;
  int iterations_per_update = 2, budget_scalars = 0;
  double budget_ms = 0;
  int final_iterations = 10;
  double online_correction_s = 0.5;
  bool compute_covariances = true;
};

}  // namespace motorcade
