#pragma once

#include <vector>

#include "core/constant_twist.hpp"
#include "core/parameters.hpp"
#include "core/robust_loss.hpp"

namespace motorcade {

enum class RelinearizationPolicy {
  kEveryN,  // reorder and relinearize everything every `relinearize_every_updates` (the paper)
  kFluid,   // correct the linear models that are off, in each update
};

/// Parameters of the pose graph: of its factors and its solver.
struct PoseGraphParams {
  /// Kinds of factors, beside those of WindowParams. Camera odometry is always on.
  bool use_motion = true, use_camera_encounter = true, use_object_encounter = true;

  /// Losses act on whitened residual norms of six dimensions.
  RobustLoss encounter_loss = RobustLoss::kHuber, motion_loss = RobustLoss::kHuber;
  double encounter_loss_scale = 4.5, motion_loss_scale = 4.5;

  /// Gauge of the camera's and of each object's graph, and the weak prior of an anchor.
  double first_pose_sigma_m = 1e-3, first_pose_sigma_rad = 1e-4;
  double object_origin_sigma_m = 1e-3, object_origin_sigma_rad = 1e-4;
  double anchor_sigma_m = 100.0, anchor_sigma_rad = 3.0;

  /// Noise of the smooth motion factors.
  AccelerationNoise acceleration{
      .along_mps2 = 1.0, .sideways_mps2 = 0.5, .vertical_mps2 = 0.3, .yaw_radps2 = 0.07, .tilt_radps2 = 0.03};

  /// Share of two camera encounters' information that goes to the encounter of the two objects.
  double object_encounter_share = 0.2;
  /// Largest distance of two objects with an encounter, and most partners of an object.
  double object_encounter_distance_m = 15.0;
  int object_encounter_partners = 1;

  RelinearizationPolicy policy = RelinearizationPolicy::kFluid;
  int relinearize_every_updates = 50;  // of kEveryN
  /// Parameters of kFluid, see IncrementalSolver::Params.
  double mismatch_tolerance = 0.02, jacobian_drift_sigmas = 0.3, substitution_tolerance = 0.02;
  int iterations_per_update = 2;
  int final_iterations = 10;  // at most, when the drive has ended
};

std::vector<Parameter> parametersOf(PoseGraphParams& params);

}  // namespace motorcade
