#pragma once

#include <Eigen/Core>

#include "core/constant_twist.hpp"
#include "core/se3.hpp"

namespace motorcade {

/// Pose and twist of a vehicle with their joint uncertainty: a constant-twist Kalman filter on SE(3).
/// Body axes: x along the direction of travel, y left, z up. The twist is (velocity [m/s], turn rate [rad/s]) in body
/// axes.
class ObjectKinematics {
 public:
  struct Params {
    AccelerationNoise acceleration{
        .along_mps2 = 2.0, .sideways_mps2 = 1.0, .vertical_mps2 = 0.5, .yaw_radps2 = 0.1, .tilt_radps2 = 0.1};
    // A vehicle rolls along its own x axis and stands upright on the road: standard deviations of what departs from it.
    double slip_mps = 0.4, slip_per_mps = 0.03, vertical_mps = 0.3, tilt_rate_radps = 0.05;
    double tilt_rad = 0.04;
  };

  ObjectKinematics() = default;
  ObjectKinematics(const SE3& T_world_body, const Vector6d& twist, const Matrix12d& covariance)
      : state_{T_world_body, twist, covariance} {}

  const SE3& pose() const { return state_.T_world_body; }
  const Vector6d& twist() const { return state_.twist; }
  Eigen::Vector3d velocityWorld_mps() const { return state_.velocityWorld_mps(); }
  double speed_mps() const { return state_.twist.head<3>().norm(); }
  double speedSigma_mps() const;
  /// Standard deviation of the position, over all axes together.
  double positionSigma_m() const;
  Matrix6d poseCovariance() const { return state_.poseCovariance(); }
  Eigen::Matrix3d velocityCovariance() const { return state_.velocityCovariance(); }

  /// Constant twist over dt, T <- T exp(twist dt); a negative dt looks back.
  void predict(double dt_s, const Params& params) { state_.predict(dt_s, params.acceleration.density()); }

  /// Takes over a pose whose estimation already used `pose()` and `poseCovariance()` as its prior; the twist follows by
  /// their correlation.
  void acceptPose(const SE3& T_world_body, const Matrix6d& covariance);

  /// Takes in that the point `p_body` of the body was observed at `p_world`; `sigma_m` along each axis.
  void fusePosition(const Eigen::Vector3d& p_body, const Eigen::Vector3d& p_world, double sigma_m);

  /// Takes in that the velocity is along the body's x axis and the body upright: `up_world` is the road's normal, away
  /// from the ground.
  void fuseVehicleModel(const Eigen::Vector3d& up_world, const Params& params);

  /// Changes the body axes: T_world_body <- T_world_body * T_body_new.
  void changeBodyFrame(const SE3& T_body_new);

 private:
  ConstantTwistState state_;
};

}  // namespace motorcade
