#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "backend/solver/incremental_solver.hpp"
#include "backend/window/considered_calibration.hpp"
#include "core/messages.hpp"

namespace motorcade {

/// The camera in one frame of the window.
struct CameraRecord {
  FrameHead head;
  VariableId x;                   // T_world_cam
  int part = 0;                   // frames of one part are linked by what was measured; the world is that of part 0
  bool weak = false;              // measurements hardly tell how it moved since the frame before
  CameraCovariances covariances;  // as last computed
};

/// Covariances of an object in one frame, as far as its graph determines them.
struct ObjectCovariances {
  Matrix6d T_cam_body;                                          // of the pose seen from the camera, right perturbation
  std::optional<Eigen::Matrix3d> velocity_cam;                  // of the velocity over ground, in the camera's axes
  std::optional<double> speed_sigma_mps, yaw_rate_sigma_radps;  // empty when the frame's pose is the object's only one
  std::optional<ObjectAcceleration> acceleration;               // with its sigmas; empty also where there are no twists
};

/// An object in one frame of the window.
struct ObjectRecord {
  ObjectObservation seen;  // without its points
  int measured = 0;        // of its points
  Timestamp stamp;
  VariableId pose, twist;          // invalid when the frame's pose is not in the graph, or where there are no twists
  std::optional<FactorId> motion;  // since the record before, where it may be replaced
  std::optional<SE3> frozen;       // T_world_body when the pose has left the window
  std::optional<ObjectCovariances> covariances;  // as last computed
};

/// An object in the frames of the window, and in the last that left it.
struct ObjectTrack {
  VariableId shared;  // by all its poses, see the graphs; invalid before the first observation and after a drop
  std::map<FrameId, ObjectRecord> records;
  bool has_gauge = false;  // one of its poses is known
};

struct FrameCovariances {
  CameraCovariances camera;
  std::map<TrackId, ObjectCovariances> objects;
};

/// Motion of an object over ground in one frame.
struct ObjectMotionEstimate {
  Eigen::Vector3d velocity_world_mps;
  double yaw_rate_radps = 0;
};

/// Trajectories of camera and objects over the newest frames, as variables of an incremental solver. A variable lives
/// from its first observation until its frame leaves the window. A derived class, a kind of graph, decides which
/// factors a frame's measurements become.
class SmoothingWindow {
 public:
  virtual ~SmoothingWindow() = default;
  SmoothingWindow(const SmoothingWindow&) = delete;
  SmoothingWindow& operator=(const SmoothingWindow&) = delete;

  /// Adds a frame with its objects, and updates the solver. Measurements that are not finite are left out. An object
  /// that the system cannot determine is dropped and starts anew with its next observation.
  virtual void add(const FrameMeasurements& measurements) = 0;
  /// Sentences about what the last `add` left out or dropped.
  const std::vector<std::string>& problems() const { return problems_; }
  /// Marginalizes the oldest frame. Poses of objects in it are kept as they are.
  void retireOldest();
  /// Iterates until the estimates stay where they are; call it when the drive has ended.
  virtual void converge() = 0;
  /// Keeps covariances in the records of their frame, in place of those that were kept before.
  void keep(FrameId frame, const FrameCovariances& covariances);

  const std::map<FrameId, CameraRecord>& frames() const { return frames_; }
  const std::map<TrackId, ObjectTrack>& tracks() const { return tracks_; }
  const IncrementalSolver& solver() const { return solver_; }
  SE3 cameraPose(FrameId frame) const { return solver_.pose(frames_.at(frame).x); }
  virtual SolverCounters counters() const { return solver_.counters(); }

  /// Present estimate of T_world_body.
  virtual SE3 objectPose(const ObjectTrack& track, FrameId frame) const = 0;
  virtual ObjectMotionEstimate objectMotion(const ObjectTrack& track, FrameId frame) const = 0;
  /// Computes covariances from the present graph; empty when the frame's pose is not in it.
  virtual std::optional<ObjectCovariances> objectCovariances(const ObjectTrack& track, FrameId frame) const = 0;
  /// Shifts of camera and objects by errors of the calibration.
  const ConsideredCalibration& calibration() const { return calibration_; }
  /// Factor, at least 1, by which variances grow because measurements are not independent.
  virtual double designEffect() const { return 1; }

 protected:
  /// `shared_name` names the variable that an object's poses share.
  SmoothingWindow(const IncrementalSolver::Params& params, std::string shared_name)
      : solver_(params), shared_name_(std::move(shared_name)) {}

  /// The object's record of a frame that the window holds, as yet without variables.
  ObjectRecord& addRecord(ObjectTrack& track, const ObjectObservation& seen);
  /// Reports what the solver found wrong, and drops the objects concerned.
  void dropTroubled(const IncrementalSolver::Report& report);
  /// Names a variable in sentences about what is wrong.
  virtual std::string nameOf(VariableId v) const;
  /// Called when the object's variables have gone.
  virtual void dropped(TrackId) {}
  /// Called when the frame and older ones are about to leave.
  virtual void retiring(FrameId) {}

  IncrementalSolver solver_;
  std::map<FrameId, CameraRecord> frames_;
  std::map<TrackId, ObjectTrack> tracks_;
  ConsideredCalibration calibration_;  // exact where a kind of graph does not tell
  std::vector<std::string> problems_;  // since the last `add`

 private:
  void retireRecord(ObjectTrack& track, FrameId oldest, std::vector<VariableId>& retired);

  std::string shared_name_;
};

}  // namespace motorcade
