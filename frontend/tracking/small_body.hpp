#pragma once

#include "core/stereo_camera.hpp"
#include "frontend/tracking/tracked_object.hpp"

namespace motorcade {

/// May an object be a person or a two-wheeler, as far as is seen of it? It is no faster than these, and its points lie
/// within what one takes up of the road. A vehicle of which little was seen yet may pass as well.
bool mayBeSmall(const TrackedObject& object);

/// May an object be a person on foot, who is followed by patches all over the body, as corners are few on clothes and
/// most of them on limbs? It is so near that the disparity tells a patch on the body from what lies half a meter
/// behind, and it moves: what stands cannot be told from what it stands before.
bool mayBeWalking(const TrackedObject& object, const StereoCamera& camera);

}  // namespace motorcade
