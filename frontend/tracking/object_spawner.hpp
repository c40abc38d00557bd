#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/tracking/object_motion.hpp"
#include "frontend/tracking/region_walkers.hpp"
#include "frontend/tracking/tracked_object.hpp"

namespace motorcade {

/// Spawns tentative objects from moving components that no object claims. Gives each its track id.
class ObjectSpawner {
 public:
  ObjectSpawner(const ObjectMotionEstimator::Params& params, const StereoCamera& camera)
      : min_points_(params.min_points), camera_(camera), motion_(params, camera) {}

  /// Spawns objects from those points of the component that are not `taken`, one for each vehicle abreast; marks their
  /// points.
  std::vector<TrackedObject> operator()(const SceneMotion& scene, const MotionComponent& component,
                                        const SE3& T_world_cam, std::vector<bool>& taken);

  /// True when a component may be a person on foot. Corners are few on clothes, so a point or two may be all there is.
  bool mayBeWalker(const MotionComponent& component, const GroundPlane& ground) const;
  /// Spawns the person. Empty unless the patches around the points surely moved together since the frame before.
  std::optional<TrackedObject> walker(const SceneMotion& scene, const SceneMotion& before,
                                      const MotionComponent& component, const SE3& T_world_cam);
  /// Spawns somebody who was found as a whole.
  TrackedObject region(const SceneMotion& scene, const RegionWalkers::Mover& mover, const SE3& T_world_cam);
  /// An id that no object has had.
  TrackId newTrack() { return TrackId{next_track_++}; }

 private:
  TrackedObject objectOf(const SceneMotion& scene, const MotionComponent& component, const SE3& T_world_cam) const;
  bool haveMoved(const TrackedObject& object, const SceneMotion& scene, const SceneMotion& before) const;

  int min_points_;
  StereoCamera camera_;
  ObjectMotionEstimator motion_;
  std::int64_t next_track_ = 0;
};

}  // namespace motorcade
