#pragma once

#include <Eigen/Core>

namespace motorcade {

/// A rigid motion in the plane: `T_a_b` takes coordinates in b to coordinates in a, p_a = T_a_b * p_b.
/// Perturbed on the right, T <- T * exp(xi) with xi = (rho [m], phi [rad]).
class SE2 {
 public:
  SE2() = default;
  SE2(double angle_rad, const Eigen::Vector2d& translation_m);

  /// Exponential and logarithm of SE(2); the logarithm's angle lies in [-pi, pi].
  static SE2 exp(const Eigen::Vector3d& xi);
  Eigen::Vector3d log() const;

  double angle_rad() const { return angle_rad_; }  // in [-pi, pi]
  const Eigen::Vector2d& translation() const { return translation_; }
  Eigen::Matrix2d rotation() const;

  SE2 inverse() const;
  SE2 operator*(const SE2& other) const;
  Eigen::Vector2d operator*(const Eigen::Vector2d& p) const;

  /// Ad with T * exp(xi) * T^-1 = exp(Ad * xi).
  Eigen::Matrix3d adjoint() const;

 private:
  double angle_rad_ = 0, sine_ = 0, cosine_ = 1;
  Eigen::Vector2d translation_ = Eigen::Vector2d::Zero();
};

}  // namespace motorcade
