#pragma once

#include <vector>

#include "frontend/tracking/see_through.hpp"
#include "frontend/tracking/tracked_object.hpp"

namespace motorcade {

/// Of two objects on one vehicle the one that was reported stays, the older if both were or neither was, and takes the
/// points of the other, which ends; not where the background is seen between them. If both were reported and the older
/// one's origin has left the view, the younger stays. `objects` are ordered by track.
void mergeDuplicates(std::vector<TrackedObject>& objects, const SeeThrough& see_through, const StereoCamera& camera);

}  // namespace motorcade
