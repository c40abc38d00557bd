#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/messages.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/tracking/life_cycle.hpp"
#include "frontend/tracking/object_kinematics.hpp"

namespace motorcade {

/// A scene point on an object, in the object's own frame.
struct BodyPoint {
  PointId point;
  Eigen::Vector3d p_body;
  Eigen::Matrix3d covariance;
  int misfits = 0;  // frames in a row in which it did not move with the body
  /// Changes to another frame: p_new = T_new_old * p_old.
  void moveTo(const SE3& T_new_old);
};

/// Puts a point into the frame of a body, with the covariance that its disparity gives.
BodyPoint toBody(const ScenePoint& point, const SE3& T_cam_body, const StereoCamera& camera);

/// A body's points as they were measured in one stereo pair.
struct MeasuredPoints {
  FeaturesPtr features;  // the pair; empty when there is none
  std::vector<ScenePoint> points;
};

/// A vehicle that the tracker follows. The body frame's origin is the middle of the points when it is confirmed, and
/// fixed to the vehicle from then on.
struct TrackedObject {
  TrackId track;
  bool born_slow = false;       // it was as slow and small as a person when it was spawned
  bool born_as_region = false;  // it was spawned from a region of the image, not from points
  bool born_labelled = false;   // and an instance label shows that region
  LifeCycle life;
  ObjectKinematics kinematics;    // in the front-end's own odometry world
  SE3 T_cam_body;                 // of the newest frame
  std::vector<BodyPoint> points;  // ordered by point
  MeasuredPoints measured;        // those of the frame in which it was measured last
  ObjectState state = ObjectState::kMoving;
  int slow_frames = 0;                                         // in a row
  Eigen::Vector3d last_middle_body = Eigen::Vector3d::Zero();  // of the points when it was measured last
  Eigen::Vector3d spawned_at_world = Eigen::Vector3d::Zero();
  std::vector<ObjectObservation> backlog;  // observations until it is confirmed, oldest first

  /// True when only a region led to it yet: it gives way to what is found by points.
  bool isGuess() const { return born_as_region && !life.reported(); }
  const BodyPoint* find(PointId point) const;
  /// Index of a point that is there.
  std::size_t indexOf(PointId point) const { return find(point) - points.data(); }
  /// Adds points and keeps the order.
  void adopt(const std::vector<BodyPoint>& more);
  /// Box around the points in body axes, grown by `margin_m`.
  Eigen::AlignedBox3d extent(double margin_m) const;
  /// Box around the points, moved by `T`, without the outermost share at each side (at most half), so that outliers do
  /// not stretch it.
  Eigen::AlignedBox3d core(const SE3& T, double left_out = 0.1) const;
  /// Median of the points, axis by axis.
  Eigen::Vector3d middle() const;
  /// Velocity relative to the world of a point on the body, in world axes.
  Eigen::Vector3d velocityAt_mps(const Eigen::Vector3d& p_body) const;
  /// True when a point has the velocity that the body has there, up to their errors.
  bool carries(const SceneFlow& flow, const SE3& T_world_cam) const;
  /// Changes the body axes, and all that is kept in them.
  void changeBodyFrame(const SE3& T_body_new);
};

}  // namespace motorcade
