#pragma once

#include <algorithm>

#include <Eigen/Core>

#include "backend/graph/packed_triangle.hpp"

namespace motorcade::test {

/// The whole symmetric [H g; g' c].
inline Eigen::MatrixXd unpacked(const PackedTriangle& H, const Eigen::Ref<const Eigen::VectorXd>& g_c) {
  const int n = H.size;
  Eigen::MatrixXd system(n + 1, n + 1);
  for (int j = 0; j < n; ++j) std::copy(H.column(j) + j, H.column(j) + n, &system(j, j));
  system.row(n) = g_c.transpose();
  system.triangularView<Eigen::StrictlyUpper>() = system.transpose();
  return system;
}

inline Eigen::MatrixXd unpacked(const Quadratic& quadratic) { return unpacked(quadratic.matrix(), quadratic.g_c); }

}  // namespace motorcade::test
