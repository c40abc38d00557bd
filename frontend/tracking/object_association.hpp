#pragma once

#include <vector>

#include "core/se3.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/tracking/tracked_object.hpp"

namespace motorcade {

/// Global nearest neighbor: matches moving components and objects one to one, at least total cost, in the world frame.
/// Returns for each component of `scene` the index of its object, or -1: not moving, or new. Further components that
/// consist of an object's points are given to it as well. None is given to an object from which the background parts
/// it.
std::vector<int> associateObjects(const std::vector<TrackedObject>& objects, const SceneMotion& scene,
                                  const SE3& T_world_cam, const StereoCamera& camera);

/// Share of a component's points that an object holds.
double sharedPoints(const TrackedObject& object, const SceneMotion& scene, const MotionComponent& component);

}  // namespace motorcade
