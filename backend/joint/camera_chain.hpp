#pragma once

#include <map>
#include <optional>
#include <vector>

#include "backend/joint/joint_params.hpp"
#include "backend/window/smoothing_window.hpp"

namespace motorcade {

/// True for a frame in which points were seen, whether or not they tell how the camera moved.
bool showsPoints(const FrameHead& head);

/// Camera poses as variables, and what links them where landmarks hardly do: the front-end's odometry, the vehicle's
/// own motion, or a steady motion over frames without points. Where nobody knows how the camera moved, a new part
/// begins.
class CameraChain {
 public:
  /// `frames` are those of the window, before the newest one.
  CameraChain(const JointParams& params, IncrementalSolver& solver, const std::map<FrameId, CameraRecord>& frames)
      : params_(params), solver_(solver), frames_(frames) {}

  /// Adds the newest frame's camera, which sees so many landmarks at rest again.
  CameraRecord add(const FrameMeasurements& measurements, int seen_again);
  /// Fixes the motion before anything was seen, as a frame leaves the window.
  void forgetStart() { start_ = {}; }

 private:
  void link(const FrameMeasurements& measurements, CameraRecord& camera);
  void linkUnseen(const FrameMeasurements& measurements, const CameraRecord& camera);
  void moveStart(Timestamp now, Timestamp seen_first);
  void moveSteadily(Timestamp now, Timestamp seen_before);
  std::optional<FactorId> addGaugePrior(VariableId x, const SE3& mean);
  std::optional<FactorId> addOdometry(const SE3& T_before_now, const Matrix6d& covariance, VariableId before,
                                      VariableId now);

  const JointParams& params_;
  IncrementalSolver& solver_;
  const std::map<FrameId, CameraRecord>& frames_;
  /// The last camera in which points were seen, and the motion since then.
  struct LastSeen {
    FrameId frame;
    SE3 T_seen_now;
  };
  LastSeen last_seen_;
  /// A step to a frame without points, by a prediction.
  struct PredictedStep {
    std::optional<FactorId> factor;
    VariableId before, now;
    Timestamp from, to;
  };
  /// Replaces the prediction by a share of a motion that took `motion_s`.
  void replace(const PredictedStep& step, const SE3& motion, double motion_s);

  std::vector<PredictedStep> unseen_;  // since points were last seen
  /// Frames before the first with points: nothing tells how the camera moved in them.
  struct UnseenStart {
    std::optional<FactorId> gauge;
    std::vector<PredictedStep> steps;
  };
  UnseenStart start_;
};

}  // namespace motorcade
