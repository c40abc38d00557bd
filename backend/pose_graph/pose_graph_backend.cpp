#include "backend/pose_graph/pose_graph_backend.hpp"

#include "backend/pose_graph/anchored_pose_graph.hpp"

namespace motorcade {

PoseGraphSmoother::PoseGraphSmoother(const PoseGraphParams& params, const WindowParams& window)
    : WindowBackend(std::make_unique<AnchoredPoseGraph>(params, window), window) {}

}  // namespace motorcade
