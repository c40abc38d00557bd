#pragma once

#include <optional>

#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/tracking/tracked_object.hpp"

namespace motorcade {

inline constexpr double kFastestWalk_mps = 3;  // who runs for a bus

/// May an object be a person or a two-wheeler, as far as is seen of it? It is no faster than these, and its points lie
/// within what one takes up of the road. A vehicle of which little was seen yet may pass as well.
bool mayBeSmall(const TrackedObject& object);

/// Is a speed that of a walk, at a depth at which patches are followed?
bool isWalk(double speed_mps, double z_m, const StereoCamera& camera);

/// May an object be a person on foot, who is followed by patches all over the body, as corners are few on clothes and
/// most of them on limbs? It is so near that the disparity tells a patch on the body from what lies half a meter
/// behind, and it moves: what stands cannot be told from what it stands before.
bool mayBeWalking(const TrackedObject& object, const StereoCamera& camera);

/// How an object moves that may be a person on foot: people walk steadily, and as well to a side of the body's axes,
/// which few points laid out. Of other objects, the kinematics of vehicles.
ObjectKinematics::Params kinematicsOf(const TrackedObject& object, const ObjectKinematics::Params& vehicle);

/// Where the image shows the trunk and head of who walks upright, and at about which disparity. Arms and legs swing,
/// and a foot on the ground rests.
struct Trunk {
  Box box;
  double disparity_px;
};
/// With the object's points around the middle of the body; empty where that is too near.
std::optional<Trunk> trunkOf(const TrackedObject& object, const SE3& T_cam_body, const GroundPlane& ground,
                             const StereoCamera& camera);

}  // namespace motorcade
