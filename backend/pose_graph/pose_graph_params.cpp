#include "backend/pose_graph/pose_graph_params.hpp"

namespace motorcade {

std::vector<Parameter> parametersOf(PoseGraphParams& params) {
  using Policy = RelinearizationPolicy;
  return {
      choiceParameter<Policy>("relinearization", params.policy, {{"every", Policy::kEveryN}, {"fluid", Policy::kFluid}},
                              "pose_graph alone: fluid relinearizes what is off; every N updates is the paper's way"),
      numberParameter("relinearize_every_updates", params.relinearize_every_updates, {1, 10000},
                      "pose_graph alone, of \"every\": fewer updates are more exact, more are faster"),
      switchParameter("factors.use_motion", params.use_motion,
                      "pose_graph alone: motion of an object between successive frames"),
      switchParameter("factors.use_camera_encounter", params.use_camera_encounter,
                      "pose_graph alone: poses of objects seen from the camera"),
      switchParameter("factors.use_object_encounter", params.use_object_encounter,
                      "pose_graph alone: poses of objects relative to each other")};
}

}  // namespace motorcade
