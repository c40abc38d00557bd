#pragma once

#include <cmath>

#include <Eigen/Core>

namespace motorcade {

/// Factors H = L D L' a small positive definite matrix, of which only the lower triangle is read. All loops have a
/// fixed length and are unrolled by the compiler.
template <int N>
class Cholesky {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;

  explicit Cholesky(const Matrix& H) {
    for (int j = 0; j < N; ++j) {
      Vector LD;  // row j of L D
      double d = H(j, j);
      for (int k = 0; k < j; ++k) {
        LD[k] = L_(j, k) * d_[k];
        d -= L_(j, k) * LD[k];
      }
      positive_ = positive_ && d > 0 && std::isfinite(d);
      d_[j] = d;
      inverse_d_[j] = 1 / d;
      for (int i = j + 1; i < N; ++i) {
        double sum = H(i, j);
        for (int k = 0; k < j; ++k) sum -= L_(i, k) * LD[k];
        L_(i, j) = sum * inverse_d_[j];
      }
    }
  }

  /// False for a matrix that is not positive definite. Nothing below may be called then.
  bool positive() const { return positive_; }

  Vector solve(Vector b) const {
    for (int i = 1; i < N; ++i)
      for (int k = 0; k < i; ++k) b[i] -= L_(i, k) * b[k];
    for (int i = N - 1; i >= 0; --i) {
      b[i] *= inverse_d_[i];
      for (int k = i + 1; k < N; ++k) b[i] -= L_(k, i) * b[k];
    }
    return b;
  }

  Matrix inverse() const {
    Matrix result;
    for (int i = 0; i < N; ++i) result.col(i) = solve(Vector::Unit(i));
    return result;
  }

 private:
  Matrix L_ = Matrix::Zero();  // below the diagonal, which is 1
  Vector d_, inverse_d_;
  bool positive_ = true;
};

}  // namespace motorcade
