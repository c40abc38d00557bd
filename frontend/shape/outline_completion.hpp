#pragma once

#include <optional>

#include "core/instance_labels.hpp"
#include "frontend/shape/outline.hpp"

namespace motorcade {

/// Completes the outline that told of the faces to the mask of the object. It adds the last of the cells that were
/// taken off at the left, which are the object's for the most part. It also adds what is too low to be told from the
/// road, above all its wheels.
void completeOutline(Outline& outline, const LevelDisparities& disparities, const ObjectView& view,
                     const StereoCamera& camera);

/// Outline by the instance label that agrees with the one found by disparities: both cover more than half of what
/// either covers, which no other label can reach. Empty where there is none, and where the label goes on beyond the
/// window, as its body would be larger than the object may be.
std::optional<Outline> labelledOutline(const Outline& outline, const LevelDisparities& disparities,
                                       const InstanceLabels& labels);

}  // namespace motorcade
