#pragma once

#include <Eigen/Core>

/// Turns of the axes of single variables in a factor's linear term.
namespace motorcade {

/// Columns M <- M R^T from a row on.
template <int N>
void turnColumns(Eigen::Map<Eigen::MatrixXd> term, Eigen::Index column, Eigen::Index row,
                 const Eigen::Matrix<double, N, N>& R) {
  for (Eigen::Index i = row; i < term.rows(); ++i)
    term.row(i).segment<N>(column) = (term.row(i).segment<N>(column) * R.transpose()).eval();
}

/// Rows and columns from `at` on of a symmetric matrix: R M R^T.
template <int N>
void turnLowerTriangle(Eigen::Map<Eigen::MatrixXd> term, Eigen::Index at, const Eigen::Matrix<double, N, N>& R) {
  for (Eigen::Index j = 0; j < at; ++j) term.col(j).segment<N>(at) = (R * term.col(j).segment<N>(at)).eval();
  const Eigen::Matrix<double, N, N> own = term.block<N, N>(at, at).template selfadjointView<Eigen::Lower>();
  term.block<N, N>(at, at) = R * own * R.transpose();
  turnColumns<N>(term, at, at + N, R);
}

}  // namespace motorcade
