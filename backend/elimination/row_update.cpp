#include "backend/elimination/row_update.hpp"

#include <cmath>

#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "backend/elimination/row_update.cpp"
#include <hwy/foreach_target.h>

#include "backend/graph/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

constexpr int kRowsAtOnce = 6;  // those of a pose

/// Reflects R and the N rows W in the column j, so that W has a zero there. The reflection is I - u u^T / (norm (norm +
/// pivot)) with u = (pivot + norm, w), and then R changes its sign: no difference of similar numbers occurs.
template <int N>
void reflect(const Panel& panel, int j, double* w) {
  const std::ptrdiff_t ld = panel.ld;
  double* const column = panel.data + j * ld;
  double by[N];
  double squared = 0;
  for (int k = 0; k < N; ++k) {
    by[k] = w[j + k * ld];
    squared += by[k] * by[k];
  }
  if (squared == 0) return;
  const double pivot = column[j], norm = std::sqrt(pivot * pivot + squared);
  const Vec of_r = broadcast(pivot / norm), of_rest = broadcast(1 / (norm + pivot));
  Vec of_w[N];
  Vec rest_of_w[N];
  for (int k = 0; k < N; ++k) of_w[k] = broadcast(by[k] / norm), rest_of_w[k] = broadcast(by[k]) * of_rest;
  for (std::ptrdiff_t i = j / kLanes * kLanes; i < ld; i += kLanes) {
    const Vec r = load(column + i);
    Vec turned = r * of_r;
    Vec w_i[N];
#pragma GCC unroll 6
    for (int k = 0; k < N; ++k) {
      w_i[k] = load(w + i + k * ld);
      turned += w_i[k] * of_w[k];
    }
    store(column + i, turned);
    const Vec sum = r + turned;
#pragma GCC unroll 6
    for (int k = 0; k < N; ++k) store(w + i + k * ld, w_i[k] - sum * rest_of_w[k]);
  }
}

/// to = from + the sum of N columns of W, each times its factor; null: from zero.
template <int N>
HWY_INLINE void combine(double* to, const double* from, const double* w, int ld, const double* factors, int n) {
  int i = 0;
  for (; i + kLanes <= n; i += kLanes) {
    Vec sum = from ? load(from + i) : broadcast(0);
#pragma GCC unroll 6
    for (int k = 0; k < N; ++k) sum += load(w + i + k * ld) * broadcast(factors[k]);
    store(to + i, sum);
  }
  for (; i < n; ++i) {
    double sum = from ? from[i] : 0;
    for (int k = 0; k < N; ++k) sum += w[i + k * ld] * factors[k];
    to[i] = sum;
  }
}

}  // namespace

void growByProductOf(double* to, int size, const double* from, const double* w, int ld, int count) {
  double factors[kRowsAtOnce];
  for (int j = size - 1; j >= 0; --j) {  // so that what is read is not overwritten
    const int n = size - j;
    double* const column = to + std::ptrdiff_t(j) * (2 * size - j + 1) / 2;
    const double* base =
        j < count ? nullptr : from + std::ptrdiff_t(j - count) * (2 * (size - count) - j + count + 1) / 2;
    for (int done = 0; done < count; done += kRowsAtOnce)
      withConstant<kRowsAtOnce>(count - done < kRowsAtOnce ? count - done : kRowsAtOnce, [&]<int N>() HWY_ATTR {
        for (int k = 0; k < N; ++k) factors[k] = w[j + (done + k) * ld];
        combine<N>(column, base, w + j + done * ld, ld, factors, n);
        base = column;
      });
  }
}

void addRowsTo(const Panel& panel, int first, double* w, int count) {
  for (; count > 0; count -= kRowsAtOnce, w += std::ptrdiff_t{kRowsAtOnce} * panel.ld)
    withConstant<kRowsAtOnce>(count < kRowsAtOnce ? count : kRowsAtOnce, [&]<int N>() HWY_ATTR {
      for (int j = first; j < panel.columns; ++j) reflect<N>(panel, j, w);
    });
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(addRowsTo);
MOTORCADE_EXPORT(growByProductOf);

void addRows(const Panel& panel, int first, double* w, int count) {
  MOTORCADE_KERNEL(addRowsTo)(panel, first, w, count);
}

void growByProduct(double* to, int size, const double* from, const double* w, int ld, int count) {
  MOTORCADE_KERNEL(growByProductOf)(to, size, from, w, ld, count);
}

}  // namespace motorcade
#endif
