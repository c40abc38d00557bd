#pragma once

#include <vector>

#include "frontend/messages.hpp"

namespace motorcade {

/// Splits vehicles side by side at the same speed, which are one component as the scene flow does not part them. Cuts
/// `members`, points of a moving `component`, at the widest gap across the travel while the pieces are wider than one
/// vehicle, `vehicle_width_m` plus their depth noise. Each piece has the component's velocity and its own centroid. A
/// component of one vehicle is returned as one piece.
std::vector<MotionComponent> splitAbreast(const MotionComponent& component, const std::vector<int>& members,
                                          const SceneMotion& scene, double vehicle_width_m);

}  // namespace motorcade
