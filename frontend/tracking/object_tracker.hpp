#pragma once

#include <optional>
#include <vector>

#include "core/messages.hpp"
#include "core/parameters.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/tracking/look_back.hpp"
#include "frontend/tracking/object_confirmation.hpp"
#include "frontend/tracking/object_motion.hpp"
#include "frontend/tracking/object_spawner.hpp"
#include "frontend/tracking/point_adoption.hpp"
#include "frontend/tracking/tracked_object.hpp"

namespace motorcade {

/// The stage `tracking`: follows the moving objects from frame to frame, in the world frame of the front-end's own
/// odometry, and measures each (encounter, motion). It runs an object's life cycle: spawned from a moving component,
/// confirmed, lost and found again, and ended. Call in frame order: the stage remembers the objects.
class ObjectTracker {
 public:
  struct Params {
    ObjectConfirmation::Params confirmation;
    int look_back_frames =
        12;                // in which a confirmed object is looked for among the points followed before its spawning
    int max_objects = 64;  // followed at a time
    int max_coasted_frames = 5;  // rows in state `predicted`
    int max_lost_frames = 15;    // after which a confirmed object that was not measured ends
    double stop_speed_mps = 0.5, start_speed_mps = 1.0;
    ObjectKinematics::Params kinematics;
    ObjectMotionEstimator::Params motion;
  };
  ObjectTracker(const Params& params, const StereoCamera& camera);

  FrameMeasurementsPtr operator()(const SceneMotionPtr& scene);

 private:
  void advance(const SceneMotion& scene);
  void endAll(FrameMeasurements& measurements);
  void follow(TrackedObject& object, const SceneMotion& scene, FrameMeasurements& measurements);
  void coast(TrackedObject& object, const SceneMotion& scene, FrameMeasurements& measurements);
  std::optional<ObjectObservation> withoutMeasurement(const TrackedObject& object, const SceneMotion& scene) const;
  void updateState(TrackedObject& object) const;
  void record(TrackedObject& object, ObjectObservation observation, FrameMeasurements& measurements);
  void confirmSure(const SceneMotion& scene, FrameMeasurements& measurements);
  void confirm(TrackedObject& object, FrameMeasurements& measurements);
  void matchComponents(const SceneMotion& scene);
  void spawnWalkers(const SceneMotion& scene, const std::vector<int>& object_of, const std::vector<bool>& taken);
  std::vector<bool> onObjects(const SceneMotion& scene) const;
  void spawnRegions(const SceneMotion& scene, const std::vector<bool>& taken);
  void dropFarthest();
  void reappear(TrackedObject& object, const MotionComponent& component) const;
  bool isOutOfReach(const TrackedObject& object) const;
  bool mayBeInImage(const TrackedObject& object) const;
  bool isOriginNearImage(const TrackedObject& object) const;
  bool isInImage(const Eigen::Vector3d& p_cam, double margin_px) const;
  void handOverPassed(FrameMeasurements& measurements);
  void removeEnded(FrameMeasurements& measurements);
  void addOtherPoints(const SceneMotion& scene, FrameMeasurements& measurements) const;

  Params params_;
  StereoCamera camera_;
  PointAdoption adopt_;
  ObjectMotionEstimator motion_;
  ObjectSpawner spawn_;
  ObjectConfirmation is_confirmed_;
  LookBack look_back_;

  SE3 T_world_cam_;
  SceneMotionPtr previous_scene_;
  std::vector<TrackedObject> objects_;  // ordered by track
};

std::vector<Parameter> parametersOf(ObjectTracker::Params& params);

}  // namespace motorcade
