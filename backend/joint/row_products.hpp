#pragma once

#include <Eigen/Core>

namespace motorcade {

/// sum += a' b of matrices of three rows that lie in memory row by row, as sums of outer products: the compiler makes
/// vectors of whatever width of the columns of `sum`, and each number is added up in the same order.
template <int Rows, int Cols>
inline void addOuterProducts(const Eigen::Matrix<double, 3, Rows, Eigen::RowMajor>& a,
                             const Eigen::Matrix<double, 3, Cols, Eigen::RowMajor>& b,
                             Eigen::Matrix<double, Rows, Cols>& sum) {
  const double *const of_a = a.data(), *const of_b = b.data();
  double* column = sum.data();
  for (int c = 0; c < Cols; ++c, column += Rows)
    for (int r = 0; r < Rows; ++r)
      column[r] += (of_a[r] * of_b[c] + of_a[Rows + r] * of_b[Cols + c]) + of_a[2 * Rows + r] * of_b[2 * Cols + c];
}

/// a b, where b lies row by row too.
inline Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rowProduct(const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>& a,
                                                               const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>& b) {
  Eigen::Matrix<double, 3, 4, Eigen::RowMajor> product;
  const double *of_a = a.data(), *const of_b = b.data();
  double* row = product.data();
  for (int r = 0; r < 3; ++r, of_a += 4, row += 4)
    for (int c = 0; c < 4; ++c)
      row[c] = (of_a[0] * of_b[c] + of_a[1] * of_b[4 + c]) + (of_a[2] * of_b[8 + c] + of_a[3] * of_b[12 + c]);
  return product;
}

}  // namespace motorcade
