#pragma once

#include <vector>

#include "backend/solver/incremental_solver.hpp"
#include "core/parameters.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// Parameters that every smoothing window has, whatever its factors are.
struct WindowParams {
  int window_frames = 1000;  // a frame is final when it leaves the window; 0 keeps everything
  double settling_s = 10;    // a frame so old has settled

  int budget_scalars = 0;  // see EliminationBudget; 0: the kind of graph decides
  double budget_ms = 0;    // for live drives: replay would not be reproducible

  bool compute_covariances = true;
  int motion_frames = kCameraCovarianceFrames;  // over which the covariance of the camera's motion is told
  CalibrationSigmas calibration{};              // is considered in covariances
  /// Time over which corrections of an object's track enter its published pose; 0 publishes each pose as it is
  /// estimated. The pose moves as the object does, as a sudden correction would look like motion.
  double online_correction_s = 0.5;

  bool use_smoothness = true;  // factors that say how vehicles move
};

std::vector<Parameter> parametersOf(WindowParams& params);

/// Solver parameters that all windows share: fluid relinearization that only the budget and the tolerances limit.
IncrementalSolver::Params windowSolverParams(const WindowParams& params);

}  // namespace motorcade
