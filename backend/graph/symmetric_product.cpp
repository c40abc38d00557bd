#include "backend/graph/symmetric_product.hpp"

#include <algorithm>

#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "backend/graph/symmetric_product.cpp"
#include <hwy/foreach_target.h>

#include "backend/graph/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

/// N columns of a symmetric matrix from `first` on: theirs and, transposed, the rows that mirror them.
template <int N>
void addSymmetricColumns(const PackedTriangle& a, int first, const double* x, double* y) {
  const int n = a.size;
  const double* columns[N];
  Vec x_c[N], partial[N]{};
  for (int c = 0; c < N; ++c) columns[c] = a.column(first + c), x_c[c] = broadcast(x[first + c]);
  int i = first + N;
  for (; i + kLanes <= n; i += kLanes) {
    const Vec x_i = load(x + i);
    Vec y_i = load(y + i);
#pragma GCC unroll 4
    for (int c = 0; c < N; ++c) {
      const Vec a_ic = load(columns[c] + i);
      y_i += a_ic * x_c[c];
      partial[c] += a_ic * x_i;
    }
    store(y + i, y_i);
  }
  for (int c = 0; c < N; ++c) {
    const double* const column = columns[c];
    double sum_c = column[first + c] * x[first + c] + sum(partial[c]);
    const auto mirror = [&](int row) HWY_ATTR {
      y[row] += column[row] * x[first + c];
      sum_c += column[row] * x[row];
    };
    for (int row = first + c + 1; row < first + N; ++row) mirror(row);
    for (int row = i; row < n; ++row) mirror(row);
    y[first + c] += sum_c;
  }
}

}  // namespace

void addProduct(const PackedTriangle& a, const double* x, double* y) {
  for (int first = 0; first < a.size; first += kLanes)
    withConstant<kLanes>(std::min(a.size - first, kLanes),
                         [&]<int N>() HWY_ATTR { addSymmetricColumns<N>(a, first, x, y); });
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(addProduct);

void addSymmetricProduct(const PackedTriangle& a, const double* x, double* y) { MOTORCADE_KERNEL(addProduct)(a, x, y); }

}  // namespace motorcade
#endif
