#include "backend/graph/packed_triangle.hpp"

#include <algorithm>

namespace motorcade {

void pack(const Eigen::Ref<const Eigen::MatrixXd>& system, Quadratic& quadratic) {
  const auto n = static_cast<int>(system.rows()) - 1;
  quadratic.lower_H.resize(PackedTriangle::length(n));
  quadratic.g_c = system.row(n).transpose();
  double* to = quadratic.lower_H.data();
  for (int j = 0; j < n; ++j) to = std::copy_n(system.col(j).data() + j, n - j, to);
}

}  // namespace motorcade
