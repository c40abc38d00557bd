#pragma once

#include <map>
#include <optional>

#include "core/ids.hpp"
#include "core/se3.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// Errors of the calibration as *considered* parameters (Schmidt 1966): constant over the drive and known by their
/// standard deviations alone. They are not estimated, as hardly any shows in a drive. They are part of every
/// covariance, in which they do not shrink with the number of points or frames.
class ConsideredCalibration {
 public:
  /// Effects of the errors, one per column, each as large as its standard deviation: S with the covariance S S'.
  using PoseShifts = Eigen::Matrix<double, 6, kCalibrationErrors>;   // right perturbation of a pose or motion
  using PointShifts = Eigen::Matrix<double, 3, kCalibrationErrors>;  // of a place or a velocity

  /// Motion of the camera up to a frame, from the last one before that was seen; in frames between, nothing shifts.
  struct Step {
    double seconds = 0;  // 0: it is not known
    SE3 T_before_now, T_world_now;
    PoseShifts shifts = PoseShifts::Zero();
  };

  /// An exact calibration.
  ConsideredCalibration() = default;
  ConsideredCalibration(const StereoCamera& camera, const CalibrationSigmas& sigmas)
      : camera_(camera), sigmas_(sigmas) {}

  const CalibrationSigmas& sigmas() const { return sigmas_; }
  /// Sets the step of this frame in place of an earlier one.
  void set(FrameId now, const Step& step);
  /// Forgets the steps before this frame: no motion from before it is asked for any more.
  void forget(FrameId oldest);

  /// Shifts of the camera's motion from one frame to a later one, T_before_now. The shifts of its steps add up, as the
  /// errors are the same ones.
  PoseShifts ofMotion(FrameId before, FrameId now, const SE3& T_world_now) const;
  /// Shifts of T_world_now, from the first frame on.
  PoseShifts ofPose(FrameId now, const SE3& T_world_now) const;
  /// Shifts of a point seen from the camera [m].
  PointShifts ofPoint(const Eigen::Vector3d& p_cam) const;
  /// Shifts of such a point's velocity over ground, in the camera's axes [m/s]; none where the frame's step is unknown.
  PointShifts ofVelocity(FrameId frame, const Eigen::Vector3d& p_cam, const Eigen::Vector3d& velocity_cam_mps) const;

 private:
  std::optional<StereoCamera> camera_;
  CalibrationSigmas sigmas_;
  struct KnownStep {
    Step step;
    PoseShifts path = PoseShifts::Zero();  // of all steps up to this one, each as a left perturbation of T_world_now
  };
  const PoseShifts& pathUpTo(FrameId frame) const;

  std::map<FrameId, KnownStep> steps_;
  PoseShifts forgotten_path_ = PoseShifts::Zero();
};

}  // namespace motorcade
