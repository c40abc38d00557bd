#pragma once

#include <Eigen/Core>

#include "core/se3.hpp"

namespace motorcade {

/// Pose and twist of a vehicle with their joint uncertainty: a constant-twist Kalman filter on SE(3).
/// Body axes: x along the direction of travel, y left, z up. The twist is (velocity [m/s], turn rate [rad/s]) in body
/// axes.
class ObjectKinematics {
 public:
  using Matrix12d = Eigen::Matrix<double, 12, 12>;

  struct Params {
    // White noise on acceleration: standard deviation of the twist's change after one second.
    double acceleration_along_mps2 = 2.0, acceleration_sideways_mps2 = 1.0, acceleration_vertical_mps2 = 0.5;
    double acceleration_yaw_radps2 = 0.1, acceleration_tilt_radps2 = 0.1;
    // A vehicle rolls along its own x axis and stands upright on the road.
    double slip_mps = 0.4, slip_per_mps = 0.03, vertical_mps = 0.3, tilt_rate_radps = 0.05;
    double tilt_rad = 0.04;
  };

  ObjectKinematics() = default;
  ObjectKinematics(const SE3& T_world_body, const Vector6d& twist, const Matrix12d& covariance)
      : T_world_body_(T_world_body), twist_(twist), covariance_(covariance) {}

  const SE3& pose() const { return T_world_body_; }
  const Vector6d& twist() const { return twist_; }
  Eigen::Vector3d velocityWorld_mps() const { return T_world_body_.rotation() * twist_.head<3>(); }
  double speed_mps() const { return twist_.head<3>().norm(); }
  double speedSigma_mps() const;
  Matrix6d poseCovariance() const { return covariance_.topLeftCorner<6, 6>(); }
  Eigen::Matrix3d velocityCovariance() const { return covariance_.block<3, 3>(6, 6); }

  /// Constant twist over dt, T <- T exp(twist dt); a negative dt looks back.
  void predict(double dt_s, const Params& params);

  /// Takes over a pose whose estimation already used `pose()` and `poseCovariance()` as its prior; the twist follows by
  /// their correlation.
  void acceptPose(const SE3& T_world_body, const Matrix6d& covariance);

  /// A place on the body, `p_body`, was seen at `p_world`; `sigma_m` along each axis.
  void fusePlace(const Eigen::Vector3d& p_body, const Eigen::Vector3d& p_world, double sigma_m);

  /// Velocity along the body's x axis, and the body upright: `up_world` is the road's normal, away from the ground.
  void fuseVehicleModel(const Eigen::Vector3d& up_world, const Params& params);

  /// Another choice of body axes: T_world_body <- T_world_body * T_body_new.
  void changeBodyFrame(const SE3& T_body_new);

 private:
  template <int N>
  void correct(const Eigen::Matrix<double, N, 1>& residual, const Eigen::Matrix<double, N, 12>& J,
               const Eigen::Matrix<double, N, 1>& sigma);

  SE3 T_world_body_;
  Vector6d twist_ = Vector6d::Zero();
  Matrix12d covariance_ = Matrix12d::Identity();  // of (pose by right perturbation, twist)
};

}  // namespace motorcade
