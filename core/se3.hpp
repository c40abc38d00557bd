#pragma once

#include <Eigen/Core>

namespace motorcade {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// [v]_x, so that hat(v) * w = v x w.
Eigen::Matrix3d hat(const Eigen::Vector3d& v);

/// Rotation matrix of a rotation vector [rad] and back; the vector's angle lies in [0, pi].
Eigen::Matrix3d expSO3(const Eigen::Vector3d& phi_rad);
Eigen::Vector3d logSO3(const Eigen::Matrix3d& rotation);

/// A rigid motion: `T_a_b` takes coordinates in b to coordinates in a, p_a = T_a_b * p_b.
/// Perturbed on the right, T <- T * exp(xi) with xi = (rho [m], phi [rad]).
class SE3 {
 public:
  SE3() : rotation_(Eigen::Matrix3d::Identity()), translation_(Eigen::Vector3d::Zero()) {}
  SE3(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation_m)
      : rotation_(rotation), translation_(translation_m) {}

  /// Exponential and logarithm of SE(3) (Barfoot, State Estimation for Robotics, 2017, section 7.1).
  static SE3 exp(const Vector6d& xi);
  Vector6d log() const;

  const Eigen::Matrix3d& rotation() const { return rotation_; }
  const Eigen::Vector3d& translation() const { return translation_; }

  SE3 inverse() const;
  SE3 operator*(const SE3& other) const;
  /// R p + t, summed in Eigen's order. It is spelled out because every source would compile Eigen's product anew.
  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const {
    const auto& R = rotation_;
    return {R(0, 0) * p[0] + (R(0, 1) * p[1] + R(0, 2) * p[2]) + translation_[0],
            R(1, 0) * p[0] + (R(1, 1) * p[1] + R(1, 2) * p[2]) + translation_[1],
            R(2, 0) * p[0] + (R(2, 1) * p[1] + R(2, 2) * p[2]) + translation_[2]};
  }

  /// The same motion with the rotation put back onto SO(3); call it where many products are chained.
  SE3 normalized() const;

  /// Ad with T * exp(xi) * T^-1 = exp(Ad * xi).
  Matrix6d adjoint() const;

 private:
  Eigen::Matrix3d rotation_;
  Eigen::Vector3d translation_;
};

/// Jr with exp(xi + d) ~ exp(xi) * exp(Jr * d), and its inverse: log(exp(xi) * exp(d)) ~ xi + Jr^-1 * d
/// (Barfoot 2017, equations 7.85 and 7.86, mirrored to the right).
Matrix6d rightJacobianSE3(const Vector6d& xi);
Matrix6d rightJacobianInverseSE3(const Vector6d& xi);

/// True when no number in it is infinite or undefined.
bool isFinite(const SE3& T);

/// The motion that `motion` becomes when its duration is scaled by `factor`, at constant twist.
SE3 scaledMotion(const SE3& motion, double factor);

}  // namespace motorcade
