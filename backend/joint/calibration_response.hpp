#pragma once

#include <functional>
#include <span>
#include <vector>

#include "backend/joint/frame_index.hpp"
#include "backend/window/considered_calibration.hpp"

namespace motorcade {

/// Shifts of the camera's path that follow from shifts of observations of landmarks at rest. They solve the normal
/// equations of a bundle adjustment over the newest frames, with a right-hand side for each calibration error. A sample
/// of the landmarks is enough.
class CalibrationResponse {
 public:
  /// `points` chooses landmarks from those at rest.
  CalibrationResponse(const StereoCamera& camera, const CalibrationSigmas& sigmas, const LandmarkNoise& noise,
                      const BodyPoints::Params& points);

  /// Adds the points at rest of a frame, in frame order.
  void observe(FrameId frame, std::span<const PointMeasurement> at_rest);

  struct FrameStep {
    FrameId before, now;
    ConsideredCalibration::PoseShifts shifts;  // of T_before_now
  };
  /// Shifts of the motions between the newest frames that showed points, oldest first.
  std::vector<FrameStep> steps(const PoseVariable& camera, const std::function<SE3(VariableId)>& pose,
                               const NoiseLevel& level, double offset_px);
  /// Shifts of the newest step at the last call of `steps`; none before it.
  const ConsideredCalibration::PoseShifts& ofNewestStep() const { return newest_; }

 private:
  std::vector<LandmarkTrack*> tracks();

  StereoCamera camera_;
  CalibrationSigmas sigmas_;
  LandmarkNoise noise_;
  BodyPoints points_;
  std::vector<LandmarkTrack> ended_;  // that lie within the newest frames
  ConsideredCalibration::PoseShifts newest_ = ConsideredCalibration::PoseShifts::Zero();
};

}  // namespace motorcade
