#pragma once

#include <optional>
#include <vector>

#include "core/stereo_camera.hpp"
#include "frontend/geometry/stereo_pose.hpp"
#include "frontend/tracking/search_by_projection.hpp"
#include "frontend/tracking/tracked_object.hpp"

namespace motorcade {

/// Measures one object in one frame from the points kept in its body frame.
class ObjectMotionEstimator {
 public:
  struct Params {
    int min_points = 3;            // that agree on a pose
    double inlier_chi2 = 12.0;     // 3 degrees of freedom
    int max_misfits = 2;           // frames in a row, after which a point is no longer counted to the body
    double weak_position_m = 2.0;  // prior that only closes directions which the points leave open
    double weak_yaw_rad = 0.15, weak_tilt_rad = 0.03;
    double evidence_margin_m = 0.8;  // by which visible evidence may lie beyond the points that are known
    PoseFitParams fit;
  };
  /// Standard deviation of the predicted position above which visible evidence is not worth looking for: an outline
  /// that is off by half a vehicle holds other points.
  static constexpr double kMaxEvidenceSigma_m = 1.5;

  ObjectMotionEstimator(const Params& params, const StereoCamera& camera) : params_(params), camera_(camera) {}

  /// Measures the pose from the body points seen in `scene`, with the predicted kinematics as prior. Where too few are
  /// seen, points found by their patches are used, too. For an object born as a walker, one point is enough if it
  /// surely moves as the body does. Updates kinematics, points and misfits. Empty (and the object unchanged but for
  /// misfits) when too few points agree. The caller fills the result's frame, track and state.
  std::optional<ObjectObservation> follow(TrackedObject& object, const SceneMotion& scene,
                                          const SE3& T_world_cam) const;

  /// Findings on an object in another frame: its pose there and the points that agree on it.
  struct Found {
    ObjectObservation observation;
    PoseFit fit;
    MeasuredPoints points;
  };
  /// Measures the pose in an earlier frame, when the object was not yet known, with a prior. It uses points that were
  /// already followed then, and those found by their patches in `later`, a frame in which they were measured. Empty
  /// when too few of them agree. Leaves the object as it is.
  std::optional<Found> lookBack(const TrackedObject& object, const SceneMotion& earlier, const MeasuredPoints& later,
                                const PosePrior& prior) const;

  /// Returns the predicted pose of an object without followed points, when enough points of unknown motion lie within
  /// its outline. Its covariance is wide, as the prediction is made of measurements that count already.
  std::optional<ObjectObservation> visibleEvidence(const TrackedObject& object, const SceneMotion& scene,
                                                   const PosePrior& predicted) const;

  /// The object's points that are observed in a scene.
  MeasuredPoints measuredPoints(const TrackedObject& object, const SceneMotion& scene) const;

  /// Adds points of a scene that may lie on an object, though nothing is known of their motion yet, to it and to its
  /// `measured` points.
  void addNearby(const SceneMotion& scene, const SE3& T_cam_body, TrackedObject& object,
                 MeasuredPoints& measured) const;
  /// Adds patches between its points, and on the trunk of who may be walking, in place of those it has.
  void addPatches(const SceneMotion& scene, const SE3& T_cam_body, TrackedObject& object,
                  MeasuredPoints& measured) const;

  /// Encounter of an object that is spawned in this frame: its points define its body frame, up to their noise.
  ObjectObservation firstObservation(const TrackedObject& object, const SceneMotion& scene) const;

 private:
  struct Observation {
    std::size_t body_point;
    const ScenePoint* now;
  };
  std::vector<Observation> observations(const TrackedObject& object, const SceneMotion& scene) const;
  std::vector<const ScenePoint*> pointsWithin(const TrackedObject& object, const SceneMotion& scene,
                                              const SE3& T_cam_body) const;
  PoseObservation observe(const BodyPoint& point, const ScenePoint& now) const;
  PosePrior weakPrior(const SE3& T_cam_body) const;
  /// Pose on which the observations and the prior agree, and the observations that fit it.
  struct Agreement {
    PoseFit fit;
    std::vector<Observation> seen;
    std::vector<double> chi2;  // of each that was seen
    std::vector<Observation> inliers;
    bool enough = false;
  };
  std::optional<Agreement> agree(const TrackedObject& object, std::vector<Observation> seen,
                                 const PosePrior& prior) const;
  bool provesWalk(const TrackedObject& object, const ScenePoint& point, const SceneMotion& scene,
                  const SE3& T_world_cam) const;
  /// Adds the points that are not seen in the scene but are found by their patches in `known`, which hold them.
  std::vector<ScenePoint> search(const TrackedObject& object, const SceneMotion& scene, const MeasuredPoints& known,
                                 const SE3& T_cam_body, std::vector<Observation>& seen) const;
  void add(const std::vector<const ScenePoint*>& points, const SE3& T_cam_body, TrackedObject& object,
           MeasuredPoints& measured) const;
  void dropMisfits(TrackedObject& object, const std::vector<Observation>& seen, const std::vector<double>& chi2) const;
  ObjectObservation measureEncounter(const TrackedObject& object, const std::vector<Observation>& inliers,
                                     const SE3& T_cam_body, double disparity_offset_px) const;
  void refinePoints(TrackedObject& object, const std::vector<Observation>& inliers) const;

  Params params_;
  StereoCamera camera_;
};

/// The point as it was measured: without the disparity offset that its disparity contains.
PointMeasurement measurementOf(const ScenePoint& point, double disparity_offset_px);

/// The point of a scene by id, or null.
const ScenePoint* findPoint(const SceneMotion& scene, PointId point);

}  // namespace motorcade
