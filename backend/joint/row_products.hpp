#if defined(MOTORCADE_ROW_PRODUCTS) == defined(HWY_TARGET_TOGGLE)
#ifdef MOTORCADE_ROW_PRODUCTS
#undef MOTORCADE_ROW_PRODUCTS
#else
#define MOTORCADE_ROW_PRODUCTS
#endif

#include <Eigen/Core>

#include "backend/graph/lanes.hpp"

HWY_BEFORE_NAMESPACE();
/// Small products of matrices that lie in memory row by row, by vectors of four numbers: each number is added up in the
/// same order, whatever the processor.
namespace motorcade::HWY_NAMESPACE {

/// sum += a' b of matrices of three rows, as sums of outer products; with `kLower` at least its lower triangle.
template <bool kLower = false, int Rows, int Cols>
HWY_INLINE void addOuterProducts(const Eigen::Matrix<double, 3, Rows, Eigen::RowMajor>& a,
                                 const Eigen::Matrix<double, 3, Cols, Eigen::RowMajor>& b,
                                 Eigen::Matrix<double, Rows, Cols>& sum) {
  static_assert(Rows % kLanes == 0);
  constexpr int kVectors = Rows / kLanes;
  Vec of_a[3][kVectors];
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < kVectors; ++i) of_a[k][i] = load(a.data() + k * Rows + i * kLanes);
  for (int c = 0; c < Cols; ++c) {
    const Vec b0 = broadcast(b(0, c)), b1 = broadcast(b(1, c)), b2 = broadcast(b(2, c));
    for (int i = kLower ? c / kLanes : 0; i < kVectors; ++i) {
      double* const at = sum.data() + c * Rows + i * kLanes;
      store(at, load(at) + ((of_a[0][i] * b0 + of_a[1][i] * b1) + of_a[2][i] * b2));
    }
  }
}

/// a b.
HWY_INLINE Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rowProduct(
    const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>& a, const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>& b) {
  Eigen::Matrix<double, 3, 4, Eigen::RowMajor> product;
  Vec of_b[4];
  for (int k = 0; k < 4; ++k) of_b[k] = load(b.data() + 4 * k);
  for (int r = 0; r < 3; ++r)
    store(product.data() + 4 * r, (broadcast(a(r, 0)) * of_b[0] + broadcast(a(r, 1)) * of_b[1]) +
                                      (broadcast(a(r, 2)) * of_b[2] + broadcast(a(r, 3)) * of_b[3]));
  return product;
}

/// L^-T of a lower triangle L, row by row.
HWY_INLINE Eigen::Matrix<double, 4, 4, Eigen::RowMajor> inverseTransposed(const Eigen::Matrix<double, 4, 4>& L) {
  Eigen::Matrix<double, 4, 4, Eigen::RowMajor> inverse = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>::Zero();
  for (int i = 0; i < 4; ++i) inverse(i, i) = 1 / L(i, i);
  for (int j = 0; j < 4; ++j)
    for (int i = j + 1; i < 4; ++i) {
      double sum = 0;
      for (int k = j; k < i; ++k) sum += L(i, k) * inverse(j, k);
      inverse(j, i) = -sum * inverse(i, i);
    }
  return inverse;
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
