#include "backend/elimination/dense_substitution.hpp"

#include <algorithm>

#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "backend/elimination/dense_substitution.cpp"
#include <hwy/foreach_target.h>

#include "backend/graph/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

/// sums[c] += m(:, c)^T x over n rows.
template <int N>
[[gnu::always_inline]] inline void addDots(const double* m, int ld, const double* x, int n, double (&sums)[N]) {
  Vec partial[N]{};
  int i = 0;
  for (; i + kLanes <= n; i += kLanes) {
    const Vec x_i = load(x + i);
#pragma GCC unroll 4
    for (int c = 0; c < N; ++c) partial[c] += load(m + i + c * ld) * x_i;
  }
  for (int c = 0; c < N; ++c) sums[c] += sum(partial[c]);
  for (; i < n; ++i)
    for (int c = 0; c < N; ++c) sums[c] += m[i + c * ld] * x[i];
}

/// N scalars from `first` on, when those after them are solved.
template <int N>
void backSubstituteColumns(const Panel& panel, int first, const double* x_separator, double* x_frontal) {
  const int ld = panel.ld, rows = panel.rows, columns = panel.columns;
  const double* const L = panel.data + first * ld;
  double sums[N];
  double inverse[N];
  for (int c = 0; c < N; ++c) {
    sums[c] = L[rows - 1 + c * ld];
    inverse[c] = 1 / L[first + c + c * ld];
  }
  addDots<N>(L + columns, ld, x_separator, rows - 1 - columns, sums);
  addDots<N>(L + first + N, ld, x_frontal + first + N, columns - first - N, sums);
  for (int c = N - 1; c >= 0; --c) {
    x_frontal[first + c] = -sums[c] * inverse[c];
    for (int r = 0; r < c; ++r) sums[r] += L[first + c + r * ld] * x_frontal[first + c];
  }
}

/// Solves for N entries of d from `first` on, in place, and takes their part out of the entries of g below.
template <int N>
void forwardSubstituteColumns(const Panel& panel, int first, double* g) {
  const int ld = panel.ld, rows = panel.rows;
  const double* const L = panel.data + first * ld;
  double d[N];
  double inverse[N];
  for (int c = 0; c < N; ++c) inverse[c] = 1 / L[first + c + c * ld];
  for (int c = 0; c < N; ++c) {
    double rest = g[first + c];
    for (int b = 0; b < c; ++b) rest -= L[first + c + b * ld] * d[b];
    g[first + c] = d[c] = rest * inverse[c];
  }
  int i = first + N;
  for (; i + kLanes <= rows - 1; i += kLanes) {
    Vec rest = load(g + i);
#pragma GCC unroll 4
    for (int c = 0; c < N; ++c) rest -= load(L + i + c * ld) * broadcast(d[c]);
    store(g + i, rest);
  }
  for (; i < rows - 1; ++i)
    for (int c = 0; c < N; ++c) g[i] -= L[i + c * ld] * d[c];
}

/// Takes the part of the first `solved` rows out of R rows from `first` on, in N vectors of columns of several
/// right-hand sides, from `y` on, and multiplies them.
template <int N, int R>
[[gnu::always_inline]] inline void reduceRows(const Panel& panel, int first, int solved, double multiplier, double* y,
                                              int stride) {
  Vec rest[R * N];
#pragma GCC unroll 8
  for (int e = 0; e < R * N; ++e) rest[e] = load(y + (first + e / N) * stride + e % N * kLanes);
  for (int k = 0; k < solved; ++k) {
    const double* const L = panel.data + first + k * panel.ld;
#pragma GCC unroll 8
    for (int e = 0; e < R * N; ++e) rest[e] -= broadcast(L[e / N]) * load(y + k * stride + e % N * kLanes);
  }
#pragma GCC unroll 8
  for (int e = 0; e < R * N; ++e) store(y + (first + e / N) * stride + e % N * kLanes, rest[e] * broadcast(multiplier));
}

/// Does so for all rows, those of the frontal scalars first.
template <int N>
void forwardSubstituteRows(const Panel& panel, double* y, int stride) {
  constexpr int kRows = 8 / N;  // as many sums as registers hold
  for (int i = 0; i < panel.columns; ++i) reduceRows<N, 1>(panel, i, i, 1 / panel.data[i + i * panel.ld], y, stride);
  int i = panel.columns;
  for (; i + kRows < panel.rows; i += kRows) reduceRows<N, kRows>(panel, i, panel.columns, 1, y, stride);
  for (; i + 1 < panel.rows; ++i) reduceRows<N, 1>(panel, i, panel.columns, 1, y, stride);
}

}  // namespace

void solveBack(const Panel& panel, const double* x_separator, double* x_frontal) {
  // The odd columns come last, that is first in the panel, so that the solved scalars are whole vectors.
  for (int end = panel.columns; end > 0; end -= kLanes) {
    withConstant<kLanes>(std::min(end, kLanes),
                         [&]<int N>() HWY_ATTR { backSubstituteColumns<N>(panel, end - N, x_separator, x_frontal); });
  }
}

void solveForward(const Panel& panel, std::span<const int> singular, double* g) {
  for (int first = 0; first < panel.columns; first += kLanes) {
    withConstant<kLanes>(std::min(panel.columns - first, kLanes),
                         [&]<int N>() HWY_ATTR { forwardSubstituteColumns<N>(panel, first, g); });
  }
  for (const int k : singular) g[k] = 0;  // it has touched nothing: its column is zero below the pivot
  for (int k = 0; k < panel.columns; ++k) panel.data[panel.rows - 1 + k * panel.ld] = g[k];
}

void solveForwardRows(const Panel& panel, double* y, int stride) {
  constexpr int kMost = 4;
  for (int first = 0; first < stride; first += kMost * kLanes)
    withConstant<kMost>(std::min((stride - first) / kLanes, kMost),
                        [&]<int N>() HWY_ATTR { forwardSubstituteRows<N>(panel, y + first, stride); });
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(solveBack);
MOTORCADE_EXPORT(solveForward);
MOTORCADE_EXPORT(solveForwardRows);

void backSubstitute(const Panel& panel, const double* x_separator, double* x_frontal) {
  MOTORCADE_KERNEL(solveBack)(panel, x_separator, x_frontal);
}

void forwardSubstitute(const Panel& panel, std::span<const int> singular, double* g) {
  MOTORCADE_KERNEL(solveForward)(panel, singular, g);
}

void forwardSubstitute(const Panel& panel, double* y, int stride) {
  MOTORCADE_KERNEL(solveForwardRows)(panel, y, stride);
}

}  // namespace motorcade
#endif
