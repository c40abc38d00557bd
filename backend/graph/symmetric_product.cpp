#include "backend/graph/symmetric_product.hpp"

#include <algorithm>
#include <cstddef>

#include "backend/graph/lanes.hpp"

namespace motorcade {

using namespace lanes;

namespace {

/// N columns of a symmetric matrix from `first` on: theirs and, transposed, the rows that mirror them.
template <int N>
void addSymmetricColumns(const double* a, int lda, int n, int first, const double* x, double* y) {
  const double* const columns = a + std::ptrdiff_t{first} * lda;
  Vec x_c[N], partial[N]{};
  for (int c = 0; c < N; ++c) x_c[c] = broadcast(x[first + c]);
  int i = first + N;
  for (; i + kLanes <= n; i += kLanes) {
    const Vec x_i = load(x + i);
    Vec y_i = load(y + i);
#pragma GCC unroll 4
    for (int c = 0; c < N; ++c) {
      const Vec a_ic = load(columns + i + c * lda);
      y_i += a_ic * x_c[c];
      partial[c] += a_ic * x_i;
    }
    store(y + i, y_i);
  }
  for (int c = 0; c < N; ++c) {
    const double* const column = columns + c * lda;
    double sum_c = column[first + c] * x[first + c] + sum(partial[c]);
    const auto mirror = [&](int row) {
      y[row] += column[row] * x[first + c];
      sum_c += column[row] * x[row];
    };
    for (int row = first + c + 1; row < first + N; ++row) mirror(row);
    for (int row = i; row < n; ++row) mirror(row);
    y[first + c] += sum_c;
  }
}

}  // namespace

void addSymmetricProduct(const double* a, int lda, int n, const double* x, double* y) {
  for (int first = 0; first < n; first += kLanes)
    withConstant<kLanes>(std::min(n - first, kLanes), [&]<int N>() { addSymmetricColumns<N>(a, lda, n, first, x, y); });
}

}  // namespace motorcade
