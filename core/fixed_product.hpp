#pragma once

#include <Eigen/Core>

namespace motorcade {

/// A * B of fixed sizes, for code that must give the same bits on every processor (core and frontend). Eigen would
/// compile its blocked kernels for each shape with more than eight rows or columns, at two seconds apiece. The sums are
/// those of Eigen's kernels without vectors: the even and the odd ones of the first 8 n terms make two chains, side by
/// side. The rest follows in order.
template <int Rows, int Inner, int Cols>
Eigen::Matrix<double, Rows, Cols> fixedProduct(const Eigen::Matrix<double, Rows, Inner>& A,
                                               const Eigen::Matrix<double, Inner, Cols>& B) {
  constexpr int kPaired = Inner / 8 * 8;
  Eigen::Matrix<double, Rows, Cols> product;
  for (int c = 0; c < Cols; ++c) {
    Eigen::Matrix<double, Rows, 1> even = Eigen::Matrix<double, Rows, 1>::Zero(), odd = even;
    for (int k = 0; k < kPaired; k += 2) {
      even += A.col(k) * B(k, c);
      odd += A.col(k + 1) * B(k + 1, c);
    }
    even += odd;
    for (int k = kPaired; k < Inner; ++k) even += A.col(k) * B(k, c);
    product.col(c) = even;
  }
  return product;
}

/// J C J^T, the covariance of J x when that of x is C.
template <int Rows, int Inner>
Eigen::Matrix<double, Rows, Rows> propagated(const Eigen::Matrix<double, Rows, Inner>& J,
                                             const Eigen::Matrix<double, Inner, Inner>& C) {
  const Eigen::Matrix<double, Inner, Rows> J_T = J.transpose();
  return fixedProduct(fixedProduct(J, C), J_T);
}

}  // namespace motorcade
