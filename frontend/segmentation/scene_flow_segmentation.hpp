#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/object_pool.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/matching/circular_matching.hpp"
#include "frontend/messages.hpp"
#include "frontend/motion/camera_odometry.hpp"
#include "frontend/motion/disparity_offset.hpp"
#include "frontend/motion/gap_bridge.hpp"
#include "frontend/motion/ground_plane.hpp"
#include "frontend/motion/own_vehicle.hpp"
#include "frontend/motion/point_tracks.hpp"
#include "frontend/segmentation/motion_segmenter.hpp"

namespace motorcade {

/// The stage *scene flow segmentation*: from stereo matches and optical flow to the camera's motion and the moving
/// parts of the scene. Call in frame order: it remembers the tracks, the camera's recent path and what it learned of
/// road and rig.
class SceneFlowSegmentation {
 public:
  struct Params {
    CircularMatching::Params circular_matching;
    EgoMotionEstimator::Params ego_motion;
    PointTracks::Params point_tracks;
    GroundPlaneEstimator::Params ground_plane;
    MotionSegmenter::Params segmenter;
    DisparityOffsetEstimator::Params disparity_offset;
  };
  SceneFlowSegmentation(const Params& params, const StereoCamera& camera);

  /// Both messages are of the same frame.
  SceneMotionPtr operator()(const StereoMatchesPtr& stereo, const OpticalFlowPtr& flow);

 private:
  using Observations = std::vector<std::optional<StereoObservation>>;  // one per flow observation
  /// Measurements of a frame, given what was known before: the followed points, where they are, and how the camera
  /// moved.
  struct MeasuredFrame {
    OpticalFlow flow;
    Observations all, of_world;
    CameraMotion camera;
  };
  MeasuredFrame measure(const StereoMatches& stereo, const OpticalFlow& flow) const;
  MeasuredFrame measure(const StereoMatches& stereo, const OpticalFlow& flow, const PredictedMotion& predicted) const;
  MeasuredFrame bridged(const StereoMatches& stereo, MeasuredFrame measured, const PredictedMotion& predicted) const;
  bool isAfterGap(Timestamp stamp) const;
  bool mayBeABadImage(const CameraMotion& camera, Timestamp stamp) const;
  Observations learnOwnVehicle(const MeasuredFrame& measured);
  SceneMotionPtr passOver(const StereoFrame& unseen);
  std::shared_ptr<SceneMotion> newMotion(const FrameHead& head, const Odometry& odometry);
  ExpectedDisparities expectDisparities(const std::vector<std::optional<KnownPoint>>& known, Timestamp stamp,
                                        const SE3& T_seen_now) const;
  void addPoints(const Observations& of_world, const std::vector<bool>& inliers, std::vector<ScenePoint>& points) const;
  std::vector<bool> testGeometry() const;
  GroundPlane findGround(const std::vector<bool>& violates_geometry, SceneMotion& motion);
  void calibrateDisparity();

  StereoCamera camera_;
  CircularMatching circular_matching_;
  CameraOdometry odometry_;
  GapBridge gap_bridge_;
  OwnVehicle own_vehicle_;
  PointTracks tracks_;
  GroundPlaneEstimator ground_plane_;
  MotionSegmenter segmenter_;
  DisparityOffsetEstimator disparity_offset_;
  ObjectPool<SceneMotion> motions_;
};

}  // namespace motorcade
