#include "backend/smoother/smoother_params.hpp"

namespace motorcade {

std::vector<Parameter> parametersOf(SmootherParams& params) {
  using Policy = RelinearizationPolicy;
  return {
      numberParameter("window_frames", params.window_frames, {0, 1e6},
                      "a frame is final when it leaves the window: longer is more exact, shorter comes earlier; 0 "
                      "keeps everything"),
      numberParameter("settling_s", params.settling_s, {0, 3600},
                      "what a killed run leaves as final is up to so old: longer is more exact, shorter leaves more"),
      choiceParameter<Policy>("relinearization", params.policy, {{"every", Policy::kEveryN}, {"fluid", Policy::kFluid}},
                              "fluid relinearizes what is off; every N updates is the paper's way"),
      numberParameter("relinearize_every_updates", params.relinearize_every_updates, {1, 10000},
                      "of \"every\": fewer updates are more exact, more are faster"),
      numberParameter("budget_scalars", params.budget_scalars, {0, 1e6},
                      "bounds the work of an update, which then costs exactness for some updates; 0: 300 for joint, no "
                      "bound for others"),
      numberParameter("budget_ms", params.budget_ms, {0, 1000}, "the same in time, only with --live; 0 sets none"),
      switchParameter("compute_covariances", params.compute_covariances, "off saves time where nobody reads them"),
      numberParameter("online_correction_s", params.online_correction_s, {0, 10},
                      "longer is smoother online, shorter follows corrections sooner; 0 publishes poses as estimated"),
      switchParameter("factors.use_motion", params.use_motion, "motion of an object between successive frames"),
      switchParameter("factors.use_smoothness", params.use_smoothness, "vehicles keep their velocity"),
      switchParameter("factors.use_camera_encounter", params.use_camera_encounter,
                      "poses of objects seen from the camera"),
      switchParameter("factors.use_object_encounter", params.use_object_encounter,
                      "poses of objects relative to each other")};
}

}  // namespace motorcade
