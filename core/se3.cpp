#include "core/se3.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "core/elementary.hpp"

namespace motorcade {
namespace {

/// Angles below which a Taylor series is exact to double precision. The closed forms of the inverse and of the coupling
/// lose more digits to cancellation, so their series reach farther.
constexpr double kSmallAngle_rad = 1e-4, kSmallAngleOfInverse_rad = 1e-3, kSmallAngleOfCoupling_rad = 1e-2;
constexpr double kSmallHalfAngle = 1e-8;  // norm of a quaternion's vector below which its logarithm is linear

/// Coefficients a = sin(t)/t, b = (1 - cos(t))/t^2, c = (t - sin(t))/t^3 of Rodrigues' formulae.
struct RodriguesCoefficients {
  double a, b, c;
};

RodriguesCoefficients rodrigues(double theta_rad) {
  const double t2 = theta_rad * theta_rad;
  if (theta_rad < kSmallAngle_rad) return {1.0 - t2 / 6.0, 0.5 - t2 / 24.0, 1.0 / 6.0 - t2 / 120.0};
  const double s = sine(theta_rad), half = sine(0.5 * theta_rad);
  return {s / theta_rad, 2.0 * half * half / t2, (theta_rad - s) / (t2 * theta_rad)};
}

Eigen::Matrix3d leftJacobianSO3(const Eigen::Vector3d& phi) {
  const auto k = rodrigues(phi.norm());
  const Eigen::Matrix3d W = hat(phi);
  return Eigen::Matrix3d::Identity() + k.b * W + k.c * W * W;
}

Eigen::Matrix3d leftJacobianInverseSO3(const Eigen::Vector3d& phi) {
  const double theta = phi.norm();
  const Eigen::Matrix3d W = hat(phi);
  const double t2 = theta * theta;
  double k = 1.0 / 12.0 + t2 / 720.0;
  if (theta >= kSmallAngleOfInverse_rad) k = 1.0 / t2 - (1.0 + cosine(theta)) / (2.0 * theta * sine(theta));
  return Eigen::Matrix3d::Identity() - 0.5 * W + k * W * W;
}

/// The block Q(rho, phi) of the left Jacobian of SE(3) (Barfoot 2017, equation 7.86b).
Eigen::Matrix3d leftJacobianCoupling(const Eigen::Vector3d& rho, const Eigen::Vector3d& phi) {
  const double t = phi.norm(), t2 = t * t;
  double a = 1.0 / 6.0 - t2 / 120.0, b = 1.0 / 24.0 - t2 / 720.0, c = 1.0 / 120.0 - t2 / 2520.0;
  if (t >= kSmallAngleOfCoupling_rad) {
    const auto [s, co] = sineCosine(t);
    a = (t - s) / (t2 * t);
    b = (t2 + 2.0 * co - 2.0) / (2.0 * t2 * t2);
    c = (2.0 * t - 3.0 * s + t * co) / (2.0 * t2 * t2 * t);
  }
  const Eigen::Matrix3d P = hat(rho), W = hat(phi);
  const Eigen::Matrix3d WP = W * P, PW = P * W, WPW = WP * W;
  return 0.5 * P + a * (WP + PW + WPW) + b * (W * WP + PW * W - 3.0 * WPW) + c * (WPW * W + W * WPW);
}

Matrix6d blocks(const Eigen::Matrix3d& diagonal, const Eigen::Matrix3d& upper_right) {
  Matrix6d m;
  m << diagonal, upper_right, Eigen::Matrix3d::Zero(), diagonal;
  return m;
}

}  // namespace

Eigen::Matrix3d hat(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Matrix3d expSO3(const Eigen::Vector3d& phi_rad) {
  const auto k = rodrigues(phi_rad.norm());
  const Eigen::Matrix3d W = hat(phi_rad);
  return Eigen::Matrix3d::Identity() + k.a * W + k.b * W * W;
}

Eigen::Vector3d logSO3(const Eigen::Matrix3d& rotation) {
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double n = q.vec().norm();
  if (n < kSmallHalfAngle) return 2.0 / q.w() * q.vec();
  return 2.0 * arcTangent(n, q.w()) / n * q.vec();
}

SE3 SE3::inverse() const { return {rotation_.transpose(), -(rotation_.transpose() * translation_)}; }

SE3 SE3::operator*(const SE3& other) const {
  return {rotation_ * other.rotation_, rotation_ * other.translation_ + translation_};
}

SE3 SE3::exp(const Vector6d& xi) {
  const Eigen::Vector3d phi = xi.tail<3>();
  return {expSO3(phi), leftJacobianSO3(phi) * xi.head<3>()};
}

Vector6d SE3::log() const {
  Vector6d xi;
  xi.tail<3>() = logSO3(rotation_);
  xi.head<3>() = leftJacobianInverseSO3(xi.tail<3>()) * translation_;
  return xi;
}

SE3 SE3::normalized() const { return {Eigen::Quaterniond(rotation_).normalized().toRotationMatrix(), translation_}; }

Matrix6d SE3::adjoint() const { return blocks(rotation_, hat(translation_) * rotation_); }

Matrix6d rightJacobianSE3(const Vector6d& xi) {
  const Eigen::Vector3d rho = -xi.head<3>(), phi = -xi.tail<3>();
  return blocks(leftJacobianSO3(phi), leftJacobianCoupling(rho, phi));
}

Matrix6d rightJacobianInverseSE3(const Vector6d& xi) {
  const Eigen::Vector3d rho = -xi.head<3>(), phi = -xi.tail<3>();
  const Eigen::Matrix3d J = leftJacobianInverseSO3(phi);
  return blocks(J, -J * leftJacobianCoupling(rho, phi) * J);
}

bool isFinite(const SE3& T) { return T.rotation().allFinite() && T.translation().allFinite(); }

SE3 scaledMotion(const SE3& motion, double factor) { return SE3::exp(factor * motion.log()); }

}  // namespace motorcade
