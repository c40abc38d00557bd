#pragma once

#include <vector>

#include "backend/joint/twist_factors.hpp"
#include "core/constant_twist.hpp"
#include "core/parameters.hpp"

namespace motorcade {

/// Parameters of the joint estimate of camera, objects and points.
struct JointParams {
  int window_frames = 1000;  // a frame is final when it leaves the window; 0 keeps everything

  int track_frames = getenv("JW") ? atoi(getenv("JW")) : 10;           // views of a landmark's track
  int max_static_landmarks = getenv("JN") ? atoi(getenv("JN")) : 800;  // followed at a time
  int max_object_landmarks = 60;   // of each object

  double offset_sigma_px = getenv("JO") ? atof(getenv("JO")) : 0.001;  // prior of the disparity offset; 0 holds it at zero


  /// Whether objects' points, and the way vehicles move, are used.
  bool use_objects = true, use_smoothness = true, use_rolling = true;

  double first_pose_sigma_m = 1e-3, first_pose_sigma_rad = 1e-4;
  /// Gauge of an object: its frame at birth; the axes may turn a little, until they lie along the travel.
  double object_origin_sigma_m = 1e-3, object_axes_sigma_rad = 0.1;
  double twist_sigma_mps = 20, twist_sigma_radps = 1;  // of an object's first twist
  double lever_sigma_m = 2;

  AccelerationNoise acceleration{
      .along_mps2 = 1.5, .sideways_mps2 = 0.5, .vertical_mps2 = 0.3, .yaw_radps2 = 0.07, .tilt_radps2 = 0.03};
  RollingNoise rolling;

  double mismatch_tolerance = getenv("JM") ? atof(getenv("JM")) : 0.05, jacobian_drift_sigmas = 0.5, substitution_tolerance = 0.05;
  int iterations_per_update = getenv("JI") ? atoi(getenv("JI")) : 2, budget_scalars = 0;
  double budget_ms = 0;
  int final_iterations = 10;
  double online_correction_s = 0.5;
  bool compute_covariances = true;
};

}  // namespace motorcade
