#pragma once

#include <span>

#include "core/se3.hpp"
#include "frontend/motion/vehicle_samples.hpp"

namespace motorcade {

/// A motion of the camera with its covariance, right perturbation.
struct UncertainMotion {
  SE3 T_then_now;
  Matrix6d covariance;
};

/// Link between the vehicle's sensors and the camera: the speed's scale, the yaw rate's bias, and the camera's
/// mounting. A Kalman filter learns them, and how noisy the sensors are, from motions that the camera measured.
///
/// Between two moments the vehicle's rear axle goes along arcs, E = prod exp([s v dt, 0, 0; 0, 0, (w - b) dt]), and so
/// the camera by M^-1 E M with its mounting M = T_vehicle_cam.
class VehicleCalibration {
 public:
  using State = Eigen::Matrix<double, 5, 1>;  // see Entry
  enum Entry { kScale, kBias, kTravelYaw, kTravelPitch, kLever };

  VehicleCalibration();

  /// Motion of the camera over pieces of the vehicle's. All speeds may be wrong by the same `slip_mps`, a deviation.
  UncertainMotion motionOver(std::span<const VehicleSamples::Piece> pieces, double slip_mps = 0) const;

  /// Measured motion of the camera minus the vehicle's, also in deviations of what is usual on roads.
  struct Surprise {
    double speed_mps = 0, speed_sigmas = 0, yaw_rate_sigmas = 0;
  };
  Surprise compare(std::span<const VehicleSamples::Piece> pieces, const UncertainMotion& seen) const;
  /// Learns from a motion that the camera measured over these pieces, from one frame to the next.
  void learn(std::span<const VehicleSamples::Piece> pieces, const UncertainMotion& seen);

  double scale() const { return state_[kScale]; }
  double bias_radps() const { return state_[kBias]; }

 private:
  using StateJacobian = Eigen::Matrix<double, 6, 5>;
  struct Difference {
    Vector6d seen_less_expected;  // along the vehicle's axes
    StateJacobian J;              // of what is expected
    double dt_s;
  };
  Difference difference(std::span<const VehicleSamples::Piece> pieces, const SE3& T_then_now) const;
  StateJacobian jacobian(std::span<const VehicleSamples::Piece> pieces, const SE3& T_then_now) const;
  void learnNoise(const Difference& found, const Vector6d& camera_variance);

  State state_;
  Eigen::Matrix<double, 5, 5> covariance_;
  double speed_variance_, yaw_rate_variance_;  // of samples, taken as constant over a frame's interval
};

}  // namespace motorcade
