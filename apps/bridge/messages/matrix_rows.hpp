#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "core/se3.hpp"

/// Matrices of results and messages, which have them row by row.
namespace motorcade {

template <int kSize>
Eigen::Matrix<double, kSize, kSize> matrixOf(const std::array<double, std::size_t{kSize} * kSize>& rows) {
  return Eigen::Map<const Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>>(rows.data());
}

template <int kSize>
std::array<double, std::size_t{kSize} * kSize> rowsOf(const Eigen::Matrix<double, kSize, kSize>& matrix) {
  std::array<double, std::size_t{kSize} * kSize> rows{};
  Eigen::Map<Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>>(rows.data()) = matrix;
  return rows;
}

/// The upper three rows.
inline std::array<double, 12> rowsOf(const SE3& T) {
  std::array<double, 12> rows{};
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> matrix(rows.data());
  matrix << T.rotation(), T.translation();
  return rows;
}

inline Eigen::Vector3d vectorFrom(const std::array<double, 3>& values) { return Eigen::Vector3d(values.data()); }

}  // namespace motorcade
