#pragma once

#include <vector>

#include "frontend/tracking/see_through.hpp"
#include "frontend/tracking/tracked_object.hpp"

namespace motorcade {

/// Merges two objects on one vehicle, unless the background is seen between them. The reported one stays, or the older
/// if both were reported or neither was; it takes the points of the other, which ends. If both were reported and the
/// older one's origin has left the view, the younger stays. `objects` are ordered by track.
void mergeDuplicates(std::vector<TrackedObject>& objects, const SeeThrough& see_through, const StereoCamera& camera);

}  // namespace motorcade
