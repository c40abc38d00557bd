#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace motorcade {

/// The lower triangle of a symmetric matrix, column by column without gaps.
struct PackedTriangle {
  const double* data = nullptr;
  int size = 0;

  static std::size_t length(int size) { return std::size_t(size) * (std::size_t(size) + 1) / 2; }
  static std::ptrdiff_t offset(int size, int column) { return std::ptrdiff_t{column} * (2 * size - column - 1) / 2; }
  /// Column j, from the diagonal on, indexed by row.
  const double* column(int j) const { return data + offset(size, j); }
};

/// Quadratic function x' H x + 2 g' x + c.
struct Quadratic {
  std::vector<double> lower_H;  // packed
  Eigen::VectorXd g_c;          // [g; c]

  PackedTriangle matrix() const { return {lower_H.data(), static_cast<int>(g_c.size()) - 1}; }
};

/// Packs the symmetric [H g; g' c], from its lower triangle.
void pack(const Eigen::Ref<const Eigen::MatrixXd>& system, Quadratic& quadratic);

}  // namespace motorcade
