#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/constant_twist.hpp"
#include "core/timestamp.hpp"

namespace motorcade {

/// Extended Kalman filter of one object: pose in the world and twist in the body's axes, constant but for white noise
/// on acceleration. The error state is (xi of the pose, right perturbation; change of the twist).
class ObjectFilter {
 public:
  struct Params {
    AccelerationNoise acceleration{
        .along_mps2 = 2.0, .sideways_mps2 = 0.5, .vertical_mps2 = 0.3, .yaw_radps2 = 0.1, .tilt_radps2 = 0.03};
    double initial_speed_sigma_mps = 10.0, initial_turn_rate_sigma_radps = 0.3;
    /// Scales the process noise of each object so that its normalized innovation squared stays near 1 per dimension.
    bool adapt_process_noise = true;
    double adaptation_time_s = 2.0;
    /// Innovations beyond this many sigma are weighted down (Huber).
    double innovation_scale = 3.0;
  };

  ObjectFilter(const Params& params, Timestamp stamp, const SE3& T_world_body, const Matrix6d& covariance);

  void predict(Timestamp stamp);
  /// Returns the innovation's normalized square per dimension, before any robust weight; empty, and nothing changes,
  /// when the measurement is unusable.
  std::optional<double> correct(const SE3& T_world_body, const Matrix6d& covariance);

  const SE3& pose() const { return state_.T_world_body; }
  Eigen::Vector3d velocityWorld_mps() const { return state_.velocityWorld_mps(); }
  Matrix6d poseCovariance() const { return state_.poseCovariance(); }
  double speedSigma_mps() const;
  double yawRate_radps() const { return state_.twist[5]; }
  double yawRateSigma_radps() const { return std::sqrt(std::max(0.0, state_.covariance(11, 11))); }

 private:
  void adaptNoise(double normalized_innovation);

  Params params_;
  Timestamp stamp_;
  double dt_s_ = 0;  // of the last prediction
  double noise_scale_ = 1.0;
  ConstantTwistState state_;
};

}  // namespace motorcade
