#pragma once

#include "core/stereo_camera.hpp"
#include "frontend/tracking/tracked_object.hpp"

namespace motorcade {

/// Decides which scene points join an object: those inside its extent that move with it, and from which the background
/// does not part it.
class PointAdoption {
 public:
  explicit PointAdoption(const StereoCamera& camera) : camera_(camera) {}

  /// Adds points that fit: those of `component`, which was matched to the object, or without one those of the whole
  /// scene. `taken[i]` marks points of some object, and is kept up to date.
  void operator()(TrackedObject& object, const SceneMotion& scene, const MotionComponent* component,
                  const SE3& T_world_cam, std::vector<bool>& taken) const;

 private:
  StereoCamera camera_;
};

/// Drops the points of an object that move apart from most of its others: they lie on another body, which seemed to
/// move alike when they joined.
void disownOtherBodies(TrackedObject& object, const SceneMotion& scene);

}  // namespace motorcade
