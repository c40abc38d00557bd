#pragma once

#include <map>
#include <optional>
#include <string>

#include "backend/factors/pose_factors.hpp"
#include "backend/pose_graph/pose_graph_params.hpp"
#include "backend/window/smoothing_window.hpp"
#include "backend/window/window_params.hpp"

namespace motorcade {

/// The paper's graph (Reddy et al. 2016, section V): one pose graph for the camera and one per object, joined by
/// anchors. The variable that an object's poses z share is its anchor a, T_world_body = a z. A pose that no factor
/// would constrain gets a weak prior on its initial value, so that any combination of switches can be solved.
class AnchoredPoseGraph final : public SmoothingWindow {
 public:
  explicit AnchoredPoseGraph(const PoseGraphParams& params, const WindowParams& window = {});

  void add(const FrameMeasurements& measurements) override;
  void converge() override;

  SE3 objectPose(const ObjectTrack& track, FrameId frame) const override;
  ObjectMotionEstimate objectMotion(const ObjectTrack& track, FrameId frame) const override;
  std::optional<ObjectCovariances> objectCovariances(const ObjectTrack& track, FrameId frame) const override;

 private:
  void addCamera(const FrameMeasurements& measurements);
  void addObjects(const FrameMeasurements& measurements);
  void addObservation(const ObjectObservation& seen, double encounter_share);
  /// Adds an object-object encounter, which is made from two camera encounters, not measured anew. It takes a share of
  /// their information, and they keep the rest, so that together they say no more than what was measured.
  void addObjectEncounter(const ObjectObservation& m, const ObjectObservation& n, double share_m, double share_n);
  void startTrack(ObjectTrack& track, const SE3& T_world_body);
  bool constrain(const ObjectTrack& track, const ObjectRecord& record, double encounter_share);
  bool addMotion(const ObjectTrack& track, const ObjectRecord& record);
  bool addSmoothness(const ObjectTrack& track, FrameId frame);
  bool addCameraEncounter(const ObjectTrack& track, const ObjectRecord& record, double share);
  void addPrior(VariableId v, const SE3& mean, double sigma_m, double sigma_rad);
  SE3 predictedPose(const ObjectTrack& track, const ObjectObservation& seen) const;
  std::optional<Vector6d> meanTwist(const ObjectTrack& track, FrameId frame) const;
  void leftOut(const ObjectObservation& seen, const std::string& what);

  PoseGraphParams params_;
  bool use_smoothness_;
};

}  // namespace motorcade
