#pragma once

#include <optional>
#include <vector>

#include "frontend/messages.hpp"

namespace motorcade {

/// Upper bound of the matches' disparities, which are known to a whole pixel at least.
float greatestDisparity_px(const std::vector<std::optional<StereoMatch>>& of_corner);

/// True when `dropHalfOccluded` looks at this corner's disparity, or may drop its match.
bool decidesHalfOcclusion(const Corner& corner, float greatest_disparity_px);

/// Drops wrong matches of half-occluded points. Close to the left border of the left image a near surface lies outside
/// the right image. Its points can only find wrong partners, which seem to be farther away and move along with it. A
/// match is dropped when most of the nearest matched corners to its right are so much nearer that a point with their
/// disparity would lie outside the right image. `of_corner` has one entry per corner.
void dropHalfOccluded(const std::vector<Corner>& corners, std::vector<std::optional<StereoMatch>>& of_corner);

}  // namespace motorcade
