#include "backend/graph/packed_triangle.hpp"

namespace motorcade {

void pack(const Eigen::Ref<const Eigen::MatrixXd>& system, Quadratic& quadratic) {
  const auto n = static_cast<int>(system.rows()) - 1;
  quadratic.g_c = system.row(n).transpose();
  quadratic.lower_H.clear();
  quadratic.lower_H.reserve(PackedTriangle::length(n));
  for (int j = 0; j < n; ++j) {
    const double* const column = system.col(j).data();
    quadratic.lower_H.insert(quadratic.lower_H.end(), column + j, column + n);
  }
}

}  // namespace motorcade
