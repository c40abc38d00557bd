#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "core/messages.hpp"
#include "core/parameters.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/tracking/object_association.hpp"
#include "frontend/tracking/object_motion.hpp"
#include "frontend/tracking/point_adoption.hpp"
#include "frontend/tracking/tracked_object.hpp"

namespace motorcade {

/// The stage `tracking`: follows the moving objects from frame to frame, in the world frame of the front-end's own
/// odometry, and measures each (encounter, motion). Birth from moving segments, confirmation, coasting and death. Call
/// in frame order: it remembers the objects.
class ObjectTracker {
 public:
  struct Params {
    int confirm_observations = 3;       // frames with a measurement before an object is reported
    double confirm_speed_mps = 1.0;     // and its speed, ...
    double confirm_significance = 9.0;  // ... in standard deviations, ...
    double confirm_travel_m = 0.5;      // ... its way since birth ...
    double confirm_extent_m = 0.3;      // ... and the span of its points
    double max_presence_sigma_m =
        1.5;  // while its place is known so well, points within its outline show that an object is there
    double confirm_extent_px = 20;  // in the image too: points whose patches overlap are one measurement
    int look_back_frames =
        12;  // before its birth in which a confirmed object is looked for among the points followed then
    int max_tentative_misses = 1;
    int max_coasted_frames = 5;   // rows in state `predicted`
    int max_lost_frames = 15;     // an object that was confirmed is known again so long after it was seen last, ...
    double max_lost_sigma_m = 3;  // ... and while its place is known so well
    double reappearance_spread_m =
        1.0;  // standard deviation of the middle of its points then about that of those seen last
    double stop_speed_mps = 0.5, start_speed_mps = 1.0;
    int stop_frames = 3;          // in a row below the stop speed
    double image_margin_px = 50;  // an unseen object this far outside the image has left
    double twin_speed_mps = 1.5;  // two objects that fit into one vehicle are one if their velocities differ by less
    double twin_slack_m = 2;      // by which they may exceed the vehicle at most, however uncertain their places are
    double birth_turn_rate_radps = 0.05;  // standard deviation
    ObjectKinematics::Params kinematics;
    ObjectAssociation::Params association;
    PointAdoption::Params adoption;
    ObjectMotionEstimator::Params motion;
  };
  ObjectTracker(const Params& params, const StereoCamera& camera);

  FrameMeasurementsPtr operator()(const SceneMotionPtr& scene);

 private:
  void advance(const SceneMotion& scene);
  void follow(TrackedObject& object, const SceneMotion& scene, FrameMeasurements& measurements);
  void associate(const SceneMotion& scene);
  void bear(const SceneMotion& scene, const Segment& segment, std::vector<bool>& taken);
  void bearOne(const SceneMotion& scene, const Segment& segment, std::vector<bool>& taken);
  void record(TrackedObject& object, ObjectObservation observation, FrameMeasurements& measurements);
  void confirm(TrackedObject& object, FrameMeasurements& measurements);
  void lookBack(TrackedObject& object, Timestamp now) const;
  void reappear(TrackedObject& object, const Segment& segment) const;
  void coast(TrackedObject& object, const SceneMotion& scene, FrameMeasurements& measurements);
  void updateState(TrackedObject& object) const;
  void mergeTwins();
  bool areTwins(const TrackedObject& older, const TrackedObject& younger) const;
  void bury(FrameMeasurements& measurements);
  bool leftView(const TrackedObject& object) const;

  Params params_;
  StereoCamera camera_;
  ObjectAssociation associate_;
  PointAdoption adopt_;
  ObjectMotionEstimator motion_;

  /// A frame of the recent past.
  struct PastScene {
    SceneMotionPtr scene;
    SE3 T_world_cam;
  };

  SE3 T_world_cam_;
  SceneMotionPtr previous_scene_;
  std::deque<PastScene> past_;          // oldest first, the previous scene last
  std::vector<TrackedObject> objects_;  // ordered by track
  std::int64_t next_track_ = 0;
};

std::vector<Parameter> parametersOf(ObjectTracker::Params& params);

}  // namespace motorcade
