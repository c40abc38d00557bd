#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "backend/joint/calibration_response.hpp"
#include "backend/joint/camera_chain.hpp"
#include "backend/joint/joint_params.hpp"
#include "backend/joint/landmarks_at_rest.hpp"
#include "backend/joint/object_chain.hpp"
#include "backend/joint/rig_offset.hpp"
#include "backend/joint/undecided_points.hpp"
#include "backend/window/smoothing_window.hpp"
#include "backend/window/window_params.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// Bundle adjustment in body frames, the world being body 0. A frame's measurements become the camera's pose, the
/// objects' poses seen from it, their twists, and factors over the landmarks of each body. The variable that an
/// object's poses share is its axes of travel.
class JointGraph final : public SmoothingWindow {
 public:
  JointGraph(const JointParams& params, const WindowParams& window, const StereoCamera& camera);

  void add(const FrameMeasurements& measurements) override;
  void converge() override;
  SolverCounters counters() const override;

  /// Pose of an object, with the axes of travel.
  SE3 objectPose(const ObjectTrack& track, FrameId frame) const override;
  /// Motion of an object; its turn is about the upright axis of travel.
  ObjectMotionEstimate objectMotion(const ObjectTrack& track, FrameId frame) const override;
  std::optional<ObjectCovariances> objectCovariances(const ObjectTrack& track, FrameId frame) const override;
  /// Design effect of the points at rest, see NoiseLevel.
  double designEffect() const override { return at_rest_.designEffect(); }

 private:
  struct TwistChanges;
  std::optional<TwistChanges> twistChanges(const ObjectTrack& track, FrameId frame) const;
  std::optional<Eigen::MatrixXd> motionCovariance(const ObjectTrack& track, const ObjectRecord& record,
                                                  const std::optional<TwistChanges>& changes) const;

  std::string nameOf(VariableId v) const override;
  void dropped(TrackId id) override;
  void retiring(FrameId oldest) override;

  void addCamera(const FrameMeasurements& measurements);
  void addObjects(const FrameMeasurements& measurements);
  void addObservation(const ObjectObservation& seen);
  LandmarkBundles& landmarksOf(TrackId id);
  void consider(const FrameMeasurements& measurements);
  void calibrate(FrameId newest);
  void tellOfOffset();
  void linearizeLandmarksAnew();
  FrameId leavingWithin(int frames) const;

  JointParams params_;
  int window_frames_;
  StereoCamera camera_;
  RigOffset offset_;
  RigShake shake_;
  CameraChain cameras_;
  LandmarksAtRest at_rest_;
  ObjectChain objects_;
  std::map<TrackId, LandmarkBundles> landmarks_;  // of the objects
  UndecidedPoints undecided_;
  CalibrationResponse response_;
  bool considers_calibration_;  // for covariances alone
  std::int64_t frame_count_ = 0;
};

}  // namespace motorcade
