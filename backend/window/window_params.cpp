#include "backend/window/window_params.hpp"

#include <limits>

namespace motorcade {

std::vector<Parameter> parametersOf(WindowParams& params) {
  return {
      numberParameter("window_frames", params.window_frames, {0, 1e6},
                      "a frame is final when it leaves the window: longer is more exact, shorter comes earlier; 0 "
                      "keeps everything"),
      numberParameter("settling_s", params.settling_s, {0, 3600},
                      "what a killed run leaves as final is up to so old: longer is more exact, shorter leaves more"),
      numberParameter("budget_scalars", params.budget_scalars, {0, 1e6},
                      "bounds the work of an update, which then costs exactness for some updates; 0: 300 for joint, no "
                      "bound for others"),
      numberParameter("budget_ms", params.budget_ms, {0, 1000}, "the same in time, only with --live; 0 sets none"),
      switchParameter("compute_covariances", params.compute_covariances, "off saves time where nobody reads them"),
      numberParameter("online_correction_s", params.online_correction_s, {0, 10},
                      "longer is smoother online, shorter follows corrections sooner; 0 publishes poses as estimated"),
      switchParameter("factors.use_smoothness", params.use_smoothness, "vehicles keep their velocity")};
}

IncrementalSolver::Params windowSolverParams(const WindowParams& params) {
  return {.policy = IncrementalSolver::Policy::kFluid,
          // No allowances: a window costs little, and objects that little ties down sway when only part of them is
          // relinearized.
          .relinearization = {.leisurely_rad = 0.01,
                              .urgent_flops = std::numeric_limits<double>::infinity(),
                              .polish_flops = std::numeric_limits<double>::infinity()},
          .iterated_scalars = 0,
          .budget = {.scalars = params.budget_scalars, .ms = params.budget_ms}};
}

}  // namespace motorcade
