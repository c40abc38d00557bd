#include "backend/joint/joint_backend.hpp"

#include "backend/joint/joint_graph.hpp"

namespace motorcade {

JointBackend::JointBackend(const Params& params, const StereoCamera& camera, const WindowParams& window)
    : WindowBackend(std::make_unique<JointGraph>(params, window, camera), window) {}

}  // namespace motorcade
