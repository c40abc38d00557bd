#include "backend/elimination/dense_kernels.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace motorcade {
namespace {

typedef double Vec __attribute__((vector_size(32)));
typedef double UnalignedVec __attribute__((vector_size(32), may_alias, aligned(8)));

constexpr int kLanes = 4;
constexpr int kTileVecs = 3;  // 12 x 4 tiles: 12 sums, 3 vectors of A and one of B fill the 16 registers
constexpr int kMaxDepth =
    48;  // columns that an outer product takes at once: what stays in the first-level caches of data and pages

Vec load(const double* from) { return *reinterpret_cast<const UnalignedVec*>(from); }
void store(double* to, Vec value) { *reinterpret_cast<UnalignedVec*>(to) = value; }
Vec broadcast(double value) { return Vec{value, value, value, value}; }
double sum(Vec v) { return (v[0] + v[2]) + (v[1] + v[3]); }

Vec loadFirst(const double* from, int count) {
  switch (count) {
    case 1:
      return Vec{from[0], 0, 0, 0};
    case 2:
      return Vec{from[0], from[1], 0, 0};
    case 3:
      return Vec{from[0], from[1], from[2], 0};
    default:
      return load(from);
  }
}

int vecsFor(int rows) { return (rows + kLanes - 1) / kLanes; }

/// Calls `f.template operator()<n>()` with the number n of 1..kMax as a constant.
template <int kMax, class F>
[[gnu::always_inline]] inline void withConstant(int n, const F& f) {
  if constexpr (kMax > 1) {
    if (n < kMax) return withConstant<kMax - 1>(n, f);
  }
  f.template operator()<kMax>();
}

/// Walks down `vecs` vectors of rows in tiles: `f.template operator()<height>(first)`. Four are two and two, as one
/// alone makes the sums wait for each other.
template <class F>
[[gnu::always_inline]] inline void forTiles(int first, int vecs, const F& f) {
  for (; vecs > kTileVecs + 1 || vecs == kTileVecs; vecs -= kTileVecs, first += kTileVecs)
    f.template operator()<kTileVecs>(first);
  for (; vecs >= 2; vecs -= 2, first += 2) f.template operator()<2>(first);
  if (vecs == 1) f.template operator()<1>(first);
}

/// 4V x N entries of a matrix, in registers.
template <int V, int N>
struct Tile {
  Vec at[V][N];

  [[gnu::always_inline]] void loadFrom(const double* m, int ld) {
#pragma GCC unroll 4
    for (int n = 0; n < N; ++n)
#pragma GCC unroll 4
      for (int v = 0; v < V; ++v) at[v][n] = load(m + n * ld + v * kLanes);
  }
  [[gnu::always_inline]] void storeTo(double* m, int ld) const {
#pragma GCC unroll 4
    for (int n = 0; n < N; ++n)
#pragma GCC unroll 4
      for (int v = 0; v < V; ++v) store(m + n * ld + v * kLanes, at[v][n]);
  }
  /// Subtracts the outer product of a column with N scalars.
  [[gnu::always_inline]] void subtract(const Vec (&column)[V], const double* scalars) {
#pragma GCC unroll 4
    for (int n = 0; n < N; ++n) {
      const Vec scalar = broadcast(scalars[n]);
#pragma GCC unroll 4
      for (int v = 0; v < V; ++v) at[v][n] -= column[v] * scalar;
    }
  }
  /// Subtracts A B^T of k columns.
  [[gnu::always_inline]] void subtractProduct(const double* a, const double* b, int ld, int k) {
    for (; k > 0; --k, a += ld, b += ld) {
      Vec column[V];
#pragma GCC unroll 4
      for (int v = 0; v < V; ++v) column[v] = load(a + v * kLanes);
      subtract(column, b);
    }
  }
};

/// L of the N columns that are being eliminated.
template <int N>
struct Triangle {
  double below[N][N]{};       // below[c][r] = L(r, c)
  double inverse[N]{};        // of the diagonal; zero where singular
  double largest_growth = 1;  // of a diagonal entry over its pivot

  /// Right-looking elimination of the tile whose first N rows are the triangle. The pivot's reciprocal updates the
  /// remaining columns while its root is still being taken.
  template <int V>
  [[gnu::always_inline]] void factorize(Tile<V, N>& tile, const double (&diagonal)[N]) {
#pragma GCC unroll 4
    for (int c = 0; c < N; ++c) {
      const double pivot = tile.at[0][c][c];
      if (!(pivot > kSingularPivot * diagonal[c] && pivot <= std::numeric_limits<double>::max())) [[unlikely]] {
        clear(tile, c);
        continue;
      }
      const double reciprocal = 1 / pivot;
      inverse[c] = std::sqrt(pivot) * reciprocal;
      largest_growth = std::max(largest_growth, diagonal[c] * reciprocal);
#pragma GCC unroll 4
      for (int r = c + 1; r < N; ++r) {
        const Vec factor = broadcast(tile.at[0][c][r] * reciprocal);
#pragma GCC unroll 4
        for (int v = 0; v < V; ++v) tile.at[v][r] -= tile.at[v][c] * factor;
      }
#pragma GCC unroll 4
      for (int v = 0; v < V; ++v) tile.at[v][c] *= broadcast(inverse[c]);
#pragma GCC unroll 4
      for (int r = c + 1; r < N; ++r) below[c][r] = tile.at[0][c][r];
    }
  }

  /// X = A L^-T for a tile of lower rows.
  template <int V>
  [[gnu::always_inline]] void solve(Tile<V, N>& tile) const {
#pragma GCC unroll 4
    for (int c = 0; c < N; ++c) {
#pragma GCC unroll 4
      for (int v = 0; v < V; ++v) {
        tile.at[v][c] *= broadcast(inverse[c]);
        if (inverse[c] == 0) [[unlikely]]
          tile.at[v][c] = Vec{};
      }
#pragma GCC unroll 4
      for (int r = c + 1; r < N; ++r)
#pragma GCC unroll 4
        for (int v = 0; v < V; ++v) tile.at[v][r] -= tile.at[v][c] * broadcast(below[c][r]);
    }
  }

 private:
  template <int V>
  [[gnu::always_inline]] void clear(Tile<V, N>& tile, int c) {
    for (int v = 0; v < V; ++v) tile.at[v][c] = Vec{};
    tile.at[0][c][c] = 1;
    for (int r = c + 1; r < N; ++r) below[c][r] = 0;
  }
};

/// Eliminates N columns from `first` on: left-looking, each tile takes all updates by earlier columns at once. Returns
/// the largest ratio of a diagonal entry to its pivot, at least 1.
template <int N>
double factorizeColumns(double* panel, int ld, int rows, int first, std::vector<int>& singular) {
  double* const columns = panel + first * ld;
  Triangle<N> triangle;
  forTiles(0, vecsFor(rows - first), [&]<int V>(int vec) {
    const int row = first + vec * kLanes;
    Tile<V, N> tile;
    tile.loadFrom(columns + row, ld);
    tile.subtractProduct(panel + row, panel + first, ld, first);
    if (vec == 0) {
      double diagonal[N];
      for (int c = 0; c < N; ++c) diagonal[c] = columns[first + c + c * ld];
      triangle.factorize(tile, diagonal);
    } else {
      triangle.solve(tile);
    }
    tile.storeTo(columns + row, ld);
  });
  for (int c = 0; c < N; ++c)
    if (triangle.inverse[c] == 0) singular.push_back(first + c);
  return triangle.largest_growth;
}

/// The outer product's operands.
struct OuterProduct {
  double* c;
  int ldc;
  const double* a;
  int lda, n, k;

  /// One tile of C. The last column of A is loaded with care: past row n its buffer may end.
  template <int V, int N>
  [[gnu::always_inline]] void subtractTile(int row, int column) const {
    Tile<V, N> tile;
    tile.loadFrom(c + row + column * ldc, ldc);
    tile.subtractProduct(a + row, a + column, lda, k - 1);
    const double* const end = a + (k - 1) * lda;
    Vec last[V];
#pragma GCC unroll 4
    for (int v = 0; v < V - 1; ++v) last[v] = load(end + row + v * kLanes);
    const int bottom = row + (V - 1) * kLanes;
    last[V - 1] = loadFirst(end + bottom, std::min(n - bottom, kLanes));
    tile.subtract(last, end + column);
    tile.storeTo(c + row + column * ldc, ldc);
  }

  /// V vectors of rows of C from its first column to the diagonal; A's rows stay in the cache.
  template <int V>
  void subtractRows(int row) const {
    for (int column = 0; column < row; column += kLanes) subtractTile<V, kLanes>(row, column);
    subtractDiagonal<V>(row);
  }

  template <int V>
  [[gnu::always_inline]] void subtractDiagonal(int row) const {
    withConstant<kLanes>(std::min(n - row, kLanes), [&]<int N>() { subtractTile<V, N>(row, row); });
    if constexpr (V > 1) subtractDiagonal<V - 1>(row + kLanes);
  }
};

/// Rows i to i + kCount - 1 of H += J^T J, of K rows of J whose columns are `stride` apart.
template <int K, int kCount>
[[gnu::always_inline]] inline void addRowsOfProduct(const double* jacobian, int stride, int i, double* h, int ldh) {
  const auto entry = [&](int k, int lane) { return lane < kCount ? jacobian[k + (i + lane) * stride] : 0.0; };
  Vec transposed[K];
#pragma GCC unroll 6
  for (int k = 0; k < K; ++k) transposed[k] = Vec{entry(k, 0), entry(k, 1), entry(k, 2), entry(k, 3)};
  for (int j = 0; j < i + kCount; ++j) {
    Vec total = load(h + i + j * ldh);
#pragma GCC unroll 6
    for (int k = 0; k < K; ++k) total += transposed[k] * broadcast(jacobian[k + j * stride]);
    store(h + i + j * ldh, total);
  }
}

template <int K>
void addProduct(const double* jacobian, int stride, int cols, double* h, int ldh) {
  int i = 0;
  for (; i + kLanes <= cols; i += kLanes) addRowsOfProduct<K, kLanes>(jacobian, stride, i, h, ldh);
  if (i < cols)
    withConstant<kLanes - 1>(cols - i, [&]<int kCount>() { addRowsOfProduct<K, kCount>(jacobian, stride, i, h, ldh); });
}

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
void backSubstituteColumns(const double* panel, int ld, int rows, int columns, int first, const double* x_separator,
                           double* x_frontal) {
  const double* const L = panel + first * ld;
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
void forwardSubstituteColumns(const double* panel, int ld, int rows, int first, double* g) {
  const double* const L = panel + first * ld;
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

}  // namespace

double factorizePanel(double* panel, int ld, int rows, int columns, std::vector<int>& singular) {
  assert(ld % kLanes == 0 && ld >= rows && rows > columns);
  double largest_growth = 1;
  for (int first = 0; first < columns; first += kLanes) {
    withConstant<kLanes>(std::min(columns - first, kLanes), [&]<int N>() {
      largest_growth = std::max(largest_growth, factorizeColumns<N>(panel, ld, rows, first, singular));
    });
  }
  return 1 / largest_growth;
}

void subtractOuterProduct(double* c, int ldc, const double* a, int lda, int n, int k) {
  assert(ldc % kLanes == 0 && ldc >= n && lda % kLanes == 0);
  const int passes = (k + kMaxDepth - 1) / kMaxDepth;
  for (int pass = 0; pass < passes; ++pass) {
    const int from = k * pass / passes, to = k * (pass + 1) / passes;
    const OuterProduct product{.c = c, .ldc = ldc, .a = a + from * lda, .lda = lda, .n = n, .k = to - from};
    forTiles(0, vecsFor(n), [&]<int V>(int vec) { product.subtractRows<V>(vec * kLanes); });
  }
}

void addJacobianProduct(const double* jacobian, int rows, int cols, double* h, int ldh) {
  assert(ldh % kLanes == 0 && ldh >= cols);
  int row = 0;
  for (; row + 6 <= rows; row += 6) addProduct<6>(jacobian + row, rows, cols, h, ldh);
  for (; row + 3 <= rows; row += 3) addProduct<3>(jacobian + row, rows, cols, h, ldh);
  for (; row < rows; ++row) addProduct<1>(jacobian + row, rows, cols, h, ldh);
}

void backSubstitute(const double* panel, int ld, int rows, int columns, const double* x_separator, double* x_frontal) {
  // The odd columns come last, that is first in the panel, so that the solved scalars are whole vectors.
  for (int end = columns; end > 0; end -= kLanes) {
    withConstant<kLanes>(std::min(end, kLanes), [&]<int N>() {
      backSubstituteColumns<N>(panel, ld, rows, columns, end - N, x_separator, x_frontal);
    });
  }
}

void forwardSubstitute(double* panel, int ld, int rows, int columns, std::span<const int> singular, double* g,
                       double& c) {
  for (int first = 0; first < columns; first += kLanes) {
    withConstant<kLanes>(std::min(columns - first, kLanes),
                         [&]<int N>() { forwardSubstituteColumns<N>(panel, ld, rows, first, g); });
  }
  for (const int k : singular) g[k] = 0;  // it has touched nothing: its column is zero below the pivot
  for (int k = 0; k < columns; ++k) {
    panel[rows - 1 + k * ld] = g[k];
    c -= g[k] * g[k];
  }
}

}  // namespace motorcade
