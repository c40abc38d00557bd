#pragma once

#include <optional>
#include <vector>

#include "frontend/messages.hpp"

namespace motorcade {

/// Drops matches that look through a near surface. Close to the left border of the left image a near surface lies
/// outside the right image: its points there can only find wrong partners, which seem farther away and move along with
/// it. A match goes when most of the nearest matched corners to its right are so much nearer that their disparity would
/// leave the right image here. One entry of `of_corner` per corner.
void dropHalfOccluded(const std::vector<Corner>& corners, std::vector<std::optional<StereoMatch>>& of_corner);

}  // namespace motorcade
