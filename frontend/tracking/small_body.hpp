#pragma once

#include <optional>

#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/tracking/tracked_object.hpp"

namespace motorcade {

inline constexpr double kFastestWalk_mps = 3;    // who runs for a bus
inline constexpr double kFastestRide_mps = 8;    // on a bicycle
inline constexpr double kSlowestWalk_mps = 0.5;  // what is slower cannot be told from what it stands before

/// True when an object may be a person or a two-wheeler, as far as is seen of it. It is no faster than these, and its
/// points lie within what one takes up of the road. A vehicle of which little was seen yet may pass as well.
bool mayBeSmall(const TrackedObject& object);

/// True when an object may be a person on foot: it is small, and as slow as one now or was so when it was spawned.
bool mayBeOnFoot(const TrackedObject& object);

/// True when a speed is that of a walk, at a depth at which patches are followed.
bool isWalk(double speed_mps, double z_m, const StereoCamera& camera);

/// True when an object may be a walking person. Such an object is followed by patches on the trunk: corners are few on
/// clothes, and most of them are on limbs. It must be so near that the disparity tells a patch on the body from what
/// lies half a meter behind. It must move: what stands cannot be told from what it stands before.
bool mayBeWalking(const TrackedObject& object, const StereoCamera& camera);

/// Kinematics of a walk for what may be a person on foot, else those of a vehicle. People walk steadily. They may go to
/// a side of the body's axes, as few points laid these out.
ObjectKinematics::Params kinematicsOf(const TrackedObject& object, const ObjectKinematics::Params& vehicle);

/// Trunk and head of a person in the image. Arms and legs are left out: they swing, and a foot on the ground rests.
struct Trunk {
  Box box;
  double disparity_px;
};
/// The trunk of an object whose points lie around the middle of the body. Empty if that is too near to be projected.
std::optional<Trunk> trunkOf(const TrackedObject& object, const SE3& T_cam_body, const GroundPlane& ground,
                             const StereoCamera& camera);

}  // namespace motorcade
