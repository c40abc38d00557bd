#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "backend/joint/body_points.hpp"
#include "backend/joint/bundle_factor.hpp"
#include "backend/joint/joint_params.hpp"
#include "backend/joint/noise_level.hpp"
#include "backend/joint/undecided_points.hpp"
#include "backend/solver/incremental_solver.hpp"
#include "core/messages.hpp"

namespace motorcade {

/// The camera in one frame of the window.
struct JointCamera {
  Timestamp stamp;
  FrameStatus status = FrameStatus::kGood;
  VariableId x;
  int gauge = 0;                       // frames of one number are linked by what was measured
  bool weak = false;                   // the points at rest hardly tell how it moved since the frame before
  std::optional<Matrix6d> covariance;  // as last computed
};

/// An object in one frame of the window.
struct JointRecord {
  ObjectObservation seen;  // without the points
  Timestamp stamp;
  VariableId c, w;                 // T_cam_body and twist; invalid when the frame's pose is not in the graph
  std::optional<FactorId> motion;  // since the record before
  std::optional<SE3> frozen;       // T_world_body when the pose has left the window
  std::optional<Matrix6d> covariance;
  std::optional<Eigen::Matrix3d> velocity_cam_covariance;  // in the camera's axes
  std::optional<double> speed_sigma_mps, yaw_rate_sigma_radps;
};

/// Tracks that ended, and the factor that holds them.
struct ClosedTracks {
  FactorId factor;
  FrameId first;  // of their views
  std::vector<LandmarkTrack> tracks;
};

/// What is known of the points of a body, and the factor over those that are followed now.
struct JointPoints {
  BodyPoints points;
  NoiseLevel noise;
  std::vector<LandmarkTrack> ended{};  // whose factor is still to be made
  std::optional<FactorId> current{};   // of these and of the tracks that go on
  std::vector<ClosedTracks> closed{};  // while the offset may still move
};

struct JointObject {
  VariableId travel;  // see travelAxes; invalid before the first observation and after a drop
  std::map<FrameId, JointRecord> records;
  JointPoints points;
};

/// Were points seen, whether or not they tell how the camera moved?
bool showsPoints(const FrameMeasurements& measurements);

/// Covariances of one frame, as far as its graph determines them.
struct JointCovariances {
  struct Object {
    TrackId track;
    Matrix6d T_cam_body;           // covariance of the pose seen from the camera, right perturbation
    Eigen::Matrix3d velocity_cam;  // of the velocity over ground, in the camera's axes
    double speed_sigma_mps = 0, yaw_rate_sigma_radps = 0;
  };
  std::optional<Matrix6d> camera;  // of T_cam(before)_cam(now), kCameraCovarianceFrames apart
  std::vector<Object> objects;
};

/// Bundle adjustment in body frames, the world being body 0: turns the measurements of frames into variables and
/// factors, and remembers which is which.
class JointGraph {
 public:
  JointGraph(const JointParams& params, const StereoCamera& camera);

  /// Adds a frame with its objects, and updates the solver.
  void add(const FrameMeasurements& measurements);
  const std::vector<std::string>& problems() const { return problems_; }
  void retireOldest();
  void converge();

  const std::map<FrameId, JointCamera>& frames() const { return frames_; }
  const std::map<TrackId, JointObject>& objects() const { return objects_; }
  /// Keeps covariances in the records of their frame, in place of those that were kept before.
  void keep(FrameId frame, const JointCovariances& covariances);
  const IncrementalSolver& solver() const { return solver_; }
  /// See NoiseLevel: of the points at rest.
  double designEffect() const { return world_.noise.designEffect(); }
  double offset_px() const;
  double offsetSigma_px() const;

  /// Axes of travel in those of the body's variables.
  Eigen::Matrix3d travelAxes(const JointObject& object) const;
  /// With the axes of travel.
  SE3 objectPose(const JointObject& object, FrameId frame) const;
  Eigen::Vector3d objectVelocity_mps(const JointObject& object, FrameId frame) const;
  /// About the upright axis of travel.
  double yawRate_radps(const JointObject& object, FrameId frame) const;

 private:
  void addCamera(const FrameMeasurements& measurements);
  void observeAtRest(const FrameMeasurements& measurements);
  void linkCamera(const FrameMeasurements& measurements, JointCamera& camera);
  std::optional<FactorId> addGaugePrior(VariableId x, const SE3& mean);
  void linkUnseen(const FrameMeasurements& measurements, const JointCamera& camera);
  void settleStart(Timestamp now, Timestamp seen_first);
  std::optional<FactorId> addOdometry(const SE3& T_before_now, const Matrix6d& covariance, VariableId before,
                                      VariableId now);
  void addObservation(const ObjectObservation& seen);
  void addObjects(const FrameMeasurements& measurements);
  SE3 cameraMotion(const JointRecord& before, const JointRecord& now) const;
  void addMotion(const JointObject& object, const JointRecord& before, JointRecord& now);
  void settleMotion(JointObject& object, FrameId newest);
  void beginObject(JointObject& object, JointRecord& record);
  void continueObject(JointObject& object, const JointRecord& before, JointRecord& record);
  void addPointsAtRest();
  std::optional<FactorId> alignNewest();
  void eliminateAtRest();
  void addPoints(JointPoints& body, const JointObject* object);
  bool closesNow(const JointObject* object) const;
  void closeEnded(JointPoints& body, const JointObject* object);
  std::optional<FactorId> addBundle(const std::vector<LandmarkTrack*>& tracks, const NoiseLevel& noise,
                                    const JointObject* object,
                                    IncrementalSolver::Lifetime lifetime = IncrementalSolver::Lifetime::kLasting);
  void holdOffset();
  void setOffsetPrior(double sigma_px);
  std::optional<double> observedOffset_px() const;
  void calibrate();
  void linearizeLandmarksAnew();
  void relinearizeClosed(JointPoints& body, const JointObject* object);
  void forgetClosed(const std::function<bool(const ClosedTracks&)>& forgotten);
  JointObject& objectOf(TrackId id);
  std::optional<FactorId> addPrior(VariableId v, const SE3& mean, const Vector6d& sigma);
  void addPrior(VariableId v, const SmallVector& mean, const SmallVector& sigma);
  void dropTroubled(const IncrementalSolver::Report& report);
  std::vector<VariableId> variablesOf(const JointObject& object) const;
  std::optional<TrackId> objectOf(VariableId v) const;
  std::string nameOf(VariableId v) const;

  JointParams params_;
  StereoCamera camera_;
  IncrementalSolver solver_;
  VariableId offset_;
  std::optional<FactorId> offset_prior_;
  bool offset_free_ = false;
  double linearized_offset_px_ = 0;
  FrameId first_frame_;
  /// The last camera in which points were seen, and the motion since then.
  struct LastSeen {
    FrameId frame;
    SE3 T_seen_now;
  };
  LastSeen last_seen_;
  /// Frames before the first in which points were seen: nothing tells how the camera moved in them.
  struct UnseenStart {
    struct Link {
      std::optional<FactorId> factor;
      VariableId before, now;
      Timestamp from, to;
    };
    std::optional<FactorId> gauge;
    std::vector<Link> links;
  };
  UnseenStart start_;
  std::int64_t added_frames_ = 0;
  JointPoints world_;
  std::vector<FactorId> alignments_;  // of cameras to landmarks at rest, since these were eliminated
  UndecidedPoints undecided_;
  std::map<FrameId, JointCamera> frames_;
  std::map<TrackId, JointObject> objects_;
  std::vector<std::string> problems_;
};

}  // namespace motorcade
