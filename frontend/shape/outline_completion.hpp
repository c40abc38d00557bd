#pragma once

#include "frontend/shape/outline.hpp"

namespace motorcade {

/// Completes the outline that told of the faces to the mask of the object. It adds the last of the cells that were
/// taken off at the left, which are the object's for the most part. It also adds what is too low to be told from the
/// road, above all its wheels.
void completeOutline(Outline& outline, const LevelDisparities& disparities, const ObjectView& view,
                     const StereoCamera& camera);

}  // namespace motorcade
