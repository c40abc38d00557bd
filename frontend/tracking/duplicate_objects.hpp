#pragma once

#include <vector>

#include "frontend/tracking/tracked_object.hpp"

namespace motorcade {

/// Of two objects on one vehicle the older stays and takes the points of the younger, which ends. `objects` are ordered
/// by track.
void mergeDuplicates(std::vector<TrackedObject>& objects);

}  // namespace motorcade
