#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include <Eigen/Cholesky>

#include "backend/elimination/dense_kernels.hpp"

/// Random problems for the dense kernels.
namespace motorcade::test {

/// Rounding of some hundred operations on numbers of size 1, with a condition below 1e3.
inline constexpr double kTol = 1e-11;

inline Eigen::MatrixXd randomMatrix(Eigen::Index rows, Eigen::Index cols, std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); });
}

/// A positive definite matrix, with eigenvalues from 1 to about 5.
inline Eigen::MatrixXd randomInformation(Eigen::Index size, std::mt19937& random) {
  const Eigen::MatrixXd J = randomMatrix(size, size, random);
  return Eigen::MatrixXd::Identity(size, size) + J.transpose() * J / static_cast<double>(size);
}

/// A matrix in the kernels' form: padded with junk, not aligned, and with guard values all around it.
class PaddedMatrix {
 public:
  explicit PaddedMatrix(const Eigen::MatrixXd& matrix, double padding = 1e3)
      : rows_(static_cast<int>(matrix.rows())), cols_(static_cast<int>(matrix.cols())), ld_(padded(rows_)) {
    buffer_.assign(kGuard + ld_ * cols_ + kGuard, kGuardValue);
    std::fill_n(data(), ld_ * cols_, padding);
    view() = matrix;
  }
  double* data() { return buffer_.data() + kGuard; }
  int ld() const { return ld_; }
  /// The matrix as a panel that eliminates as many scalars as it has columns.
  Panel panel() { return {.data = data(), .ld = ld_, .rows = rows_, .columns = cols_}; }
  Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>> view() {
    return {data(), rows_, cols_, Eigen::OuterStride<>(ld_)};
  }
  Eigen::MatrixXd lower() { return view().triangularView<Eigen::Lower>(); }
  bool intactAround() const {
    const auto isGuard = [](double value) { return value == kGuardValue; };
    return std::all_of(buffer_.begin(), buffer_.begin() + kGuard, isGuard) &&
           std::all_of(buffer_.end() - kGuard, buffer_.end(), isGuard);
  }

 private:
  static constexpr std::ptrdiff_t kGuard = 17;  // odd: an address that is not a multiple of 32 bytes
  static constexpr double kGuardValue = 4.25e77;
  int rows_, cols_, ld_;
  std::vector<double> buffer_;
};

/// [H; g^T] with its factor, for a panel that eliminates the first `columns` of them.
struct Elimination {
  Eigen::MatrixXd whole;  // [H g; g^T c]
  int columns;

  Elimination(int rows, int eliminated, std::mt19937& random)
      : whole(randomInformation(rows, random)), columns(eliminated) {}
  int rows() const { return static_cast<int>(whole.rows()); }
  Eigen::MatrixXd panel() const { return whole.leftCols(columns); }
  Eigen::MatrixXd factor() const { return Eigen::MatrixXd(whole.llt().matrixL()).leftCols(columns); }
};

template <class F>
void forManySizes(const F& check) {
  std::mt19937 random(7);
  for (int columns = 1; columns <= 40; ++columns)
    for (const int below : {1, 2, 3, 4, 5, 6, 7, 12, 13, 16, 19, 33, 50})
      check(Elimination(columns + below, columns, random), random);
}

}  // namespace motorcade::test
