#include "core/se2.hpp"

#include <cmath>
#include <numbers>

#include "core/elementary.hpp"

namespace motorcade {
namespace {

/// Angle below which a Taylor series is exact to double precision.
constexpr double kSmallTurn_rad = 1e-4;

double wrapped(double angle_rad) { return std::remainder(angle_rad, 2 * std::numbers::pi); }

/// V with exp(rho, phi) = (phi, V rho): V = [a -b; b a], a = sin(phi) / phi, b = (1 - cos(phi)) / phi.
struct LeftJacobian {
  double a, b;
  explicit LeftJacobian(double phi)
      : a(std::abs(phi) < kSmallTurn_rad ? 1 - phi * phi / 6 : sine(phi) / phi),
        b(std::abs(phi) < kSmallTurn_rad ? phi / 2 - phi * phi * phi / 24 : 2 * sine(phi / 2) * sine(phi / 2) / phi) {}
};

}  // namespace

SE2::SE2(double angle_rad, const Eigen::Vector2d& translation_m)
    : angle_rad_(wrapped(angle_rad)), translation_(translation_m) {
  const auto [sine, cosine] = sineCosine(angle_rad_);
  sine_ = sine, cosine_ = cosine;
}

SE2 SE2::exp(const Eigen::Vector3d& xi) {
  const LeftJacobian V(xi[2]);
  return {xi[2], {V.a * xi[0] - V.b * xi[1], V.b * xi[0] + V.a * xi[1]}};
}

Eigen::Vector3d SE2::log() const {
  const LeftJacobian V(angle_rad_);
  const double determinant = V.a * V.a + V.b * V.b;
  return {(V.a * translation_.x() + V.b * translation_.y()) / determinant,
          (V.a * translation_.y() - V.b * translation_.x()) / determinant, angle_rad_};
}

Eigen::Matrix2d SE2::rotation() const { return (Eigen::Matrix2d() << cosine_, -sine_, sine_, cosine_).finished(); }

SE2 SE2::inverse() const { return {-angle_rad_, -(rotation().transpose() * translation_)}; }

SE2 SE2::operator*(const SE2& other) const { return {angle_rad_ + other.angle_rad_, *this * other.translation_}; }

Eigen::Vector2d SE2::operator*(const Eigen::Vector2d& p) const { return rotation() * p + translation_; }

Eigen::Matrix3d SE2::adjoint() const {
  Eigen::Matrix3d Ad = Eigen::Matrix3d::Identity();
  Ad.topLeftCorner<2, 2>() = rotation();
  Ad(0, 2) = translation_.y();
  Ad(1, 2) = -translation_.x();
  return Ad;
}

}  // namespace motorcade
