#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Core>

#include "core/se3.hpp"

/// Parts of results as the public interface has them, for tests that write results down.
namespace motorcade::test {

inline constexpr double kHalfTurn = std::numbers::pi;  // of rotations
inline constexpr double kRounding = 1e-12;             // of a few operations on numbers of about one

inline std::array<double, 12> rowsByHand(const SE3& T) {
  std::array<double, 12> rows{};
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> matrix(rows.data());
  matrix << T.rotation(), T.translation();
  return rows;
}

inline std::array<double, 36> rowsByHand(const Matrix6d& covariance) {
  std::array<double, 36> rows{};
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(rows.data()) = covariance;
  return rows;
}

inline Matrix6d matrixOfRows(const std::array<double, 36>& rows) {
  return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(rows.data());
}

/// A full covariance without symmetries that could hide a mistake.
inline Matrix6d unevenCovariance() {
  Matrix6d root;
  for (int i = 0; i < 36; ++i) root(i / 6, i % 6) = 0.1 * std::sin(1.0 + 7.0 * i);
  return root * root.transpose() + 0.01 * Matrix6d::Identity();
}

inline Matrix6d diagonal(double rho, double phi) {
  Vector6d variances;
  variances << rho, rho, rho, phi, phi, phi;
  return variances.asDiagonal();
}

inline SE3 turned(const Eigen::Vector3d& phi_rad, const Eigen::Vector3d& t_m = Eigen::Vector3d::Zero()) {
  return {expSO3(phi_rad), t_m};
}

}  // namespace motorcade::test
