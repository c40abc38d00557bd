#pragma once

#include <Eigen/Core>

#include "core/se3.hpp"

namespace motorcade {

using Matrix12d = Eigen::Matrix<double, 12, 12>;

/// A P A^T.
Matrix12d congruence(const Matrix12d& A, const Matrix12d& P);

/// White noise on a vehicle's acceleration: standard deviation of the twist's change after one second, in body axes
/// (x ahead, y left, z up).
struct AccelerationNoise {
  double along_mps2, sideways_mps2, vertical_mps2, yaw_radps2, tilt_radps2;
  /// Spectral density of the noise on (velocity, turn rate), per second.
  Vector6d density() const;
};

/// State of a Kalman filter on SE(3): pose and twist of a vehicle with their joint covariance. The twist is constant
/// but for white noise on acceleration.
struct ConstantTwistState {
  SE3 T_world_body;
  Vector6d twist = Vector6d::Zero();             // (velocity [m/s], turn rate [rad/s]) in body axes
  Matrix12d covariance = Matrix12d::Identity();  // of (pose by right perturbation, twist)

  /// Constant twist over dt, T <- T exp(twist dt), with noise of this spectral density; a negative dt looks back.
  void predict(double dt_s, const Vector6d& acceleration_density);

  Eigen::Vector3d velocityWorld_mps() const { return T_world_body.rotation() * twist.head<3>(); }
  Matrix6d poseCovariance() const { return covariance.topLeftCorner<6, 6>(); }
  Eigen::Matrix3d velocityCovariance() const { return covariance.block<3, 3>(6, 6); }
};

}  // namespace motorcade
