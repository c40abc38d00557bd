#pragma once

#include "backend/smoother/factors.hpp"
#include "core/timestamp.hpp"

namespace motorcade {

/// Extended Kalman filter of one object: pose in the world and twist in the body's axes, constant but for white noise
/// on acceleration. The error state is (xi of the pose, right perturbation; change of the twist).
class ObjectFilter {
 public:
  struct Params {
    AccelerationNoise acceleration;
    double initial_speed_sigma_mps, initial_turn_rate_sigma_radps;
    bool adapt_process_noise;
    double adaptation_time_s;
    double innovation_scale;
  };

  ObjectFilter(const Params& params, Timestamp stamp, const SE3& T_world_body, const Matrix6d& covariance);

  void predict(Timestamp stamp);
  /// Returns the innovation's normalized square per dimension, before any robust weight; empty, and nothing changes,
  /// when the measurement is unusable.
  std::optional<double> correct(const SE3& T_world_body, const Matrix6d& covariance);

  const SE3& pose() const { return T_world_body_; }
  Eigen::Vector3d velocityWorld_mps() const { return T_world_body_.rotation() * twist_.head<3>(); }
  Matrix6d poseCovariance() const { return P_.topLeftCorner<6, 6>(); }
  double speedSigma_mps() const;

 private:
  using Matrix12d = Eigen::Matrix<double, 12, 12>;

  Params params_;
  Timestamp stamp_;
  double dt_s_ = 0;  // of the last prediction
  double noise_scale_ = 1.0;
  SE3 T_world_body_;
  Vector6d twist_ = Vector6d::Zero();
  Matrix12d P_ = Matrix12d::Zero();
};

}  // namespace motorcade
