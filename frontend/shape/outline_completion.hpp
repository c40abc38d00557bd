#pragma once

#include "frontend/shape/outline.hpp"

namespace motorcade {

/// Makes the outline that told of the faces the mask of the object: with the last of the cells that were taken off at
/// the left, which are the object's for the most part, and with what is too low to be told from the road, its wheels
/// above all.
void completeOutline(Outline& outline, const LevelDisparities& disparities, const ObjectView& view,
                     const StereoCamera& camera);

}  // namespace motorcade
