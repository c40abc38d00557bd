#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "backend/smoother/factors.hpp"
#include "backend/smoother/smoother_params.hpp"
#include "backend/solver/incremental_solver.hpp"
#include "core/messages.hpp"

namespace motorcade {

/// The camera in one frame of the window.
struct CameraRecord {
  Timestamp stamp;
  FrameStatus status = FrameStatus::kGood;
  VariableId x;
  std::optional<Matrix6d> covariance;  // as last computed
};

/// An object in one frame of the window.
struct ObjectRecord {
  ObjectObservation seen;
  Timestamp stamp;
  VariableId z;               // invalid when the frame's pose is not in the graph
  std::optional<SE3> frozen;  // T_world_body when the pose has left the window
  std::optional<Matrix6d> covariance;
  std::optional<double> speed_sigma_mps, yaw_rate_sigma_radps;
};

/// An object's own pose graph and what joins it to the world.
struct ObjectTrack {
  VariableId anchor;                        // invalid before the first observation and after a drop
  std::map<FrameId, ObjectRecord> records;  // of the window, and the last that left it
};

/// Covariances of one frame, as far as its graph determines them.
struct FrameCovariances {
  struct Object {
    TrackId track;
    Matrix6d T_cam_body;  // covariance of the pose seen from the camera, right perturbation
    std::optional<double> speed_sigma_mps,
        yaw_rate_sigma_radps;  // empty when the frame's pose is the object's only one
  };
  std::optional<Matrix6d> camera;  // of T_cam(before)_cam(now), kCameraCovarianceFrames apart
  std::vector<Object> objects;
};

/// Turns the measurements of frames into variables and factors, and remembers which is which. A pose that no factor
/// would constrain gets a weak prior on its initial value, so that any combination of switches can be solved.
class TrajectoryGraph {
 public:
  explicit TrajectoryGraph(const SmootherParams& params);

  /// Adds a frame with its objects, and updates the solver. Measurements that are no numbers are left out, and an
  /// object that the system cannot determine is dropped: it starts anew with its next observation.
  void add(const FrameMeasurements& measurements);
  /// What was left out or dropped in the last `add`, in sentences about camera and objects.
  const std::vector<std::string>& problems() const { return problems_; }
  /// Marginalizes the oldest frame.
  void retireOldest();
  /// Iterates until the estimates stay where they are; call it when the drive has ended.
  void converge();
  /// Keeps covariances in the records of their frame, in place of those that were kept before.
  void keep(FrameId frame, const FrameCovariances& covariances);

  const std::map<FrameId, CameraRecord>& frames() const { return frames_; }
  const std::map<TrackId, ObjectTrack>& tracks() const { return tracks_; }
  const IncrementalSolver& solver() const { return solver_; }

  /// T_world_body as it is estimated now.
  SE3 objectPose(const ObjectTrack& track, FrameId frame) const;

 private:
  void addCamera(const FrameMeasurements& measurements);
  void addObservation(const ObjectObservation& seen, double encounter_share);
  /// An object-object encounter is made from the same two camera encounters, not measured anew. So it takes a share of
  /// their information, and they keep the rest: what all of them say together is no more than what was measured.
  void addObjectEncounter(const ObjectObservation& m, const ObjectObservation& n, double share_m, double share_n);
  void startTrack(ObjectTrack& track, const SE3& T_world_body);
  bool constrain(const ObjectTrack& track, const ObjectRecord& record, double encounter_share);
  bool addMotion(const ObjectTrack& track, const ObjectRecord& record);
  bool addSmoothness(const ObjectTrack& track, FrameId frame);
  bool addCameraEncounter(const ObjectTrack& track, const ObjectRecord& record, double share);
  void addPrior(VariableId v, const SE3& mean, double sigma_m, double sigma_rad);
  SE3 predictedPose(const ObjectTrack& track, const ObjectObservation& seen) const;
  void dropTroubled(const IncrementalSolver::Report& report);
  std::vector<VariableId> variablesOf(const ObjectTrack& track) const;
  std::optional<TrackId> objectOf(VariableId v) const;
  std::string nameOf(VariableId v) const;
  void leftOut(const ObjectObservation& seen, const std::string& what);

  SmootherParams params_;
  IncrementalSolver solver_;
  std::map<FrameId, CameraRecord> frames_;
  std::map<TrackId, ObjectTrack> tracks_;
  std::vector<std::string> problems_;
};

}  // namespace motorcade
