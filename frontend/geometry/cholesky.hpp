#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Core>

namespace motorcade {

/// Factors H = L D L' of a small positive definite matrix; only the lower triangle is read. All loops have a fixed
/// length and are unrolled.
template <int N>
class Cholesky {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;

  explicit Cholesky(const Matrix& H) {
#pragma GCC unroll 8
    for (int j = 0; j < N; ++j) {
      Vector LD;  // row j of L D
      double d = H(j, j);
#pragma GCC unroll 8
      for (int k = 0; k < j; ++k) {
        LD[k] = L_(j, k) * d_[k];
        d -= L_(j, k) * LD[k];
      }
      positive_ = positive_ && d > 0 && std::isfinite(d);
      d_[j] = d;
      inverse_d_[j] = 1 / d;
#pragma GCC unroll 8
      for (int i = j + 1; i < N; ++i) {
        double sum = H(i, j);
#pragma GCC unroll 8
        for (int k = 0; k < j; ++k) sum -= L_(i, k) * LD[k];
        L_(i, j) = sum * inverse_d_[j];
      }
    }
  }

  /// True for a positive definite matrix. Nothing below may be called for another one.
  bool positive() const { return positive_; }

  Vector solve(Vector b) const {
    substitute(b);
    return b;
  }

  Matrix inverse() const {
    std::array<Row, N> rows;  // of the unit matrix, then of the inverse
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < kParts * kLanes; ++j) rows[i].parts[j / kLanes][j % kLanes] = i == j ? 1 : 0;
    substitute(rows);
    Matrix result;
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; ++j) result(i, j) = rows[i].parts[j / kLanes][j % kLanes];
    return result;
  }

 private:
  using Two = double __attribute__((vector_size(16)));
  static constexpr int kLanes = 2, kParts = (N + kLanes - 1) / kLanes;

  /// Row of several right-hand sides.
  struct Row {
    std::array<Two, kParts> parts;
    Row& operator*=(double factor) {
      for (Two& part : parts) part *= factor;
      return *this;
    }
    Row& operator-=(const Row& other) {
      for (int p = 0; p < kParts; ++p) parts[p] -= other.parts[p];
      return *this;
    }
    friend Row operator*(double factor, Row row) { return row *= factor; }
  };

  /// Solves for a vector, or for all columns of a matrix at once.
  template <class Rows>
  void substitute(Rows& b) const {
#pragma GCC unroll 8
    for (int i = 1; i < N; ++i)
#pragma GCC unroll 8
      for (int k = 0; k < i; ++k) b[i] -= L_(i, k) * b[k];
#pragma GCC unroll 8
    for (int i = N - 1; i >= 0; --i) {
      b[i] *= inverse_d_[i];
#pragma GCC unroll 8
      for (int k = i + 1; k < N; ++k) b[i] -= L_(k, i) * b[k];
    }
  }

  Matrix L_;  // only what is below the diagonal, which is 1
  Vector d_, inverse_d_;
  bool positive_ = true;
};

}  // namespace motorcade
