#include "backend/elimination/dense_kernels.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <type_traits>

#define MOTORCADE_WIDE_KERNELS
#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "backend/elimination/dense_kernels.cpp"
#include <hwy/foreach_target.h>

#include "backend/graph/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

/// Vectors of as many numbers as the longest registers hold, but at least four.
#if HWY_TARGET <= HWY_AVX3
typedef double Wide __attribute__((vector_size(64)));  // NOLINT(modernize-use-using): the attribute belongs to it
#else
using Wide = Vec;
#endif
template <class Vector>
constexpr int kLanesOf = static_cast<int>(sizeof(Vector) / sizeof(double));

/// Tiles of three vectors by four columns: 12 sums, 3 vectors of A and one of B fill the 16 registers. Of smaller
/// registers, a vector takes two.
constexpr int kTileVecs = 3, kTileVecsOfProduct = kParts == 1 ? kTileVecs : 1;
/// Columns that an outer product takes at once: what stays in the first-level caches of data and pages.
constexpr int kMaxDepth = 48;

int vecsFor(int rows) { return (rows + kLanes - 1) / kLanes; }

template <class Vector>
HWY_INLINE Vector loadAs(const double* from) {
  Vector vector;
  __builtin_memcpy(&vector, from, sizeof(Vector));
  return vector;
}
/// The first `count` numbers and zeros; reads nothing past them.
template <class Vector>
HWY_INLINE Vector loadFirstAs(const double* from, int count) {
  if constexpr (std::is_same_v<Vector, Vec>) {
    return loadFirst(from, count);
  } else {
    if (count >= kLanesOf<Vector>) return loadAs<Vector>(from);
    double numbers[kLanesOf<Vector>]{};
    for (int i = 0; i < count; ++i) numbers[i] = from[i];
    return loadAs<Vector>(numbers);
  }
}

/// Walks down `vecs` vectors of rows in tiles: `f.template operator()<height>(first)`. Four are two and two, as one
/// alone makes the sums wait for each other.
template <int kMost, class F>
[[gnu::always_inline]] inline void forTiles(int first, int vecs, const F& f) {
  if constexpr (kMost > 1) {
    for (; vecs > kMost + 1 || vecs == kMost; vecs -= kMost, first += kMost) f.template operator()<kMost>(first);
    for (; vecs >= 2; vecs -= 2, first += 2) f.template operator()<2>(first);
  }
  for (; vecs > 0; --vecs, ++first) f.template operator()<1>(first);
}

/// Walks down `vecs` vectors of four rows from a row on, in tiles of wide vectors and of what these leave over:
/// `f.template operator()<Vector, height>(row)`.
template <int kMost, class F>
[[gnu::always_inline]] inline void forRows(int row, int vecs, const F& f) {
  constexpr int kPerWide = kLanesOf<Wide> / kLanes;
  forTiles<kMost>(0, vecs / kPerWide,
                  [&]<int V>(int vec) HWY_ATTR { f.template operator()<Wide, V>(row + vec * kLanesOf<Wide>); });
  if (kPerWide > 1 && vecs % kPerWide > 0) f.template operator()<Vec, 1>(row + (vecs - 1) * kLanes);
}

/// V vectors of rows by N columns of a matrix, in registers.
template <class Vector, int V, int N>
struct Tile {
  static constexpr int kStep = kLanesOf<Vector>;
  Vector at[V][N];

  [[gnu::always_inline]] void loadFrom(const double* m, int ld) {
#pragma GCC unroll 4
    for (int n = 0; n < N; ++n)
#pragma GCC unroll 4
      for (int v = 0; v < V; ++v) at[v][n] = loadAs<Vector>(m + n * ld + v * kStep);
  }
  [[gnu::always_inline]] void storeTo(double* m, int ld) const {
#pragma GCC unroll 4
    for (int n = 0; n < N; ++n)
#pragma GCC unroll 4
      for (int v = 0; v < V; ++v) __builtin_memcpy(m + n * ld + v * kStep, &at[v][n], sizeof(Vector));
  }
  /// Subtracts the outer product of a column with N scalars.
  [[gnu::always_inline]] void subtract(const Vector (&column)[V], const double* scalars) {
#pragma GCC unroll 4
    for (int n = 0; n < N; ++n) {
      const double scalar = scalars[n];
#pragma GCC unroll 4
      for (int v = 0; v < V; ++v) at[v][n] -= column[v] * scalar;
    }
  }
  /// Subtracts A B^T of k columns.
  [[gnu::always_inline]] void subtractProduct(const double* a, const double* b, int ld, int k) {
    for (; k > 0; --k, a += ld, b += ld) {
      Vector column[V];
#pragma GCC unroll 4
      for (int v = 0; v < V; ++v) column[v] = loadAs<Vector>(a + v * kStep);
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
  [[gnu::always_inline]] void factorize(Tile<Vec, V, N>& tile, const double (&diagonal)[N]) {
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
  template <class Vector, int V>
  [[gnu::always_inline]] void solve(Tile<Vector, V, N>& tile) const {
#pragma GCC unroll 4
    for (int c = 0; c < N; ++c) {
#pragma GCC unroll 4
      for (int v = 0; v < V; ++v) {
        tile.at[v][c] *= inverse[c];
        if (inverse[c] == 0) [[unlikely]]
          tile.at[v][c] = Vector{};
      }
#pragma GCC unroll 4
      for (int r = c + 1; r < N; ++r)
#pragma GCC unroll 4
        for (int v = 0; v < V; ++v) tile.at[v][r] -= tile.at[v][c] * below[c][r];
    }
  }

 private:
  template <int V>
  [[gnu::always_inline]] void clear(Tile<Vec, V, N>& tile, int c) {
    for (int v = 0; v < V; ++v) tile.at[v][c] = Vec{};
    tile.at[0][c].set(c, 1);
    for (int r = c + 1; r < N; ++r) below[c][r] = 0;
  }
};

/// Eliminates N columns from `first` on: left-looking, each tile takes all updates by earlier columns at once. Returns
/// the largest ratio of a diagonal entry to its pivot, at least 1.
template <int N>
double factorizeColumns(const Panel& panel, int first, std::vector<int>& singular) {
  const int ld = panel.ld, rows = panel.rows;
  double* const columns = panel.data + first * ld;
  Triangle<N> triangle;
  const auto updated = [&]<class Vector, int V>(int row) HWY_ATTR {
    Tile<Vector, V, N> tile;
    tile.loadFrom(columns + row, ld);
    tile.subtractProduct(panel.data + row, panel.data + first, ld, first);
    return tile;
  };
  // The first tile's rows are rounded otherwise than those of others: its height is the same for all instructions.
  const int vecs = vecsFor(rows - first), top = std::min(vecs, vecs == kTileVecs + 1 ? 2 : kTileVecs);
  withConstant<kTileVecs>(top, [&]<int V>() HWY_ATTR {
    auto tile = updated.template operator()<Vec, V>(first);
    double diagonal[N];
    for (int c = 0; c < N; ++c) diagonal[c] = columns[first + c + c * ld];
    triangle.factorize(tile, diagonal);
    tile.storeTo(columns + first, ld);
  });
  forRows<kTileVecs>(first + top * kLanes, vecs - top, [&]<class Vector, int V>(int row) HWY_ATTR {
    auto tile = updated.template operator()<Vector, V>(row);
    triangle.solve(tile);
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
  template <class Vector, int V, int N>
  [[gnu::always_inline]] void subtractTile(int row, int column) const {
    constexpr int kStep = kLanesOf<Vector>;
    Tile<Vector, V, N> tile;
    tile.loadFrom(c + row + column * ldc, ldc);
    tile.subtractProduct(a + row, a + column, lda, k - 1);
    const double* const end = a + (k - 1) * lda;
    Vector last[V];
#pragma GCC unroll 4
    for (int v = 0; v < V - 1; ++v) last[v] = loadAs<Vector>(end + row + v * kStep);
    const int bottom = row + (V - 1) * kStep;
    last[V - 1] = loadFirstAs<Vector>(end + bottom, std::min(n - bottom, kStep));
    tile.subtract(last, end + column);
    tile.storeTo(c + row + column * ldc, ldc);
  }

  /// V vectors of rows of C from its first column to the diagonal; A's rows stay in the cache.
  template <class Vector, int V>
  void subtractRows(int row) const {
    for (int column = 0; column < row; column += kLanes) subtractTile<Vector, V, kLanes>(row, column);
    subtractDiagonal<V * kLanesOf<Vector> / kLanes>(row);
  }

  /// The lower triangle of V vectors of four rows.
  template <int V>
  [[gnu::always_inline]] void subtractDiagonal(int row) const {
    withConstant<kLanes>(std::min(n - row, kLanes), [&]<int N>() HWY_ATTR {
      forTiles<kTileVecs>(
          0, V, [&]<int kHeight>(int vec) HWY_ATTR { subtractTile<Vec, kHeight, N>(row + vec * kLanes, row); });
    });
    if constexpr (V > 1) subtractDiagonal<V - 1>(row + kLanes);
  }
};

/// Rows i to i + kCount - 1 of H += J^T J, of K rows of J whose columns are `stride` apart.
template <int K, int kCount>
[[gnu::always_inline]] inline void addRowsOfProduct(const double* jacobian, int stride, int i, double* h, int ldh) {
  const auto entry = [&](int k, int lane) HWY_ATTR { return lane < kCount ? jacobian[k + (i + lane) * stride] : 0.0; };
  Vec transposed[K];
#pragma GCC unroll 6
  for (int k = 0; k < K; ++k) transposed[k] = four(entry(k, 0), entry(k, 1), entry(k, 2), entry(k, 3));
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
    withConstant<kLanes - 1>(cols - i,
                             [&]<int kCount>() HWY_ATTR { addRowsOfProduct<K, kCount>(jacobian, stride, i, h, ldh); });
}

}  // namespace

double factorize(const Panel& panel, std::vector<int>& singular) {
  assert(panel.ld % kLanes == 0 && panel.ld >= panel.rows && panel.rows > panel.columns);
  double largest_growth = 1;
  for (int first = 0; first < panel.columns; first += kLanes) {
    withConstant<kLanes>(std::min(panel.columns - first, kLanes), [&]<int N>() HWY_ATTR {
      largest_growth = std::max(largest_growth, factorizeColumns<N>(panel, first, singular));
    });
  }
  return 1 / largest_growth;
}

void subtractProduct(double* c, int ldc, const double* a, int lda, int n, int k) {
  assert(ldc % kLanes == 0 && ldc >= n && lda % kLanes == 0);
  const int passes = (k + kMaxDepth - 1) / kMaxDepth;
  for (int pass = 0; pass < passes; ++pass) {
    const int from = k * pass / passes, to = k * (pass + 1) / passes;
    const OuterProduct product{.c = c, .ldc = ldc, .a = a + from * lda, .lda = lda, .n = n, .k = to - from};
    forRows<kTileVecsOfProduct>(0, vecsFor(n),
                                [&]<class Vector, int V>(int row) HWY_ATTR { product.subtractRows<Vector, V>(row); });
  }
}

void addProductOf(const double* jacobian, int rows, int cols, double* h, int ldh) {
  assert(ldh % kLanes == 0 && ldh >= cols);
  int row = 0;
  for (; row + 6 <= rows; row += 6) addProduct<6>(jacobian + row, rows, cols, h, ldh);
  for (; row + 3 <= rows; row += 3) addProduct<3>(jacobian + row, rows, cols, h, ldh);
  for (; row < rows; ++row) addProduct<1>(jacobian + row, rows, cols, h, ldh);
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(factorize);
MOTORCADE_EXPORT(subtractProduct);
MOTORCADE_EXPORT(addProductOf);

double factorizePanel(const Panel& panel, std::vector<int>& singular) {
  return MOTORCADE_KERNEL(factorize)(panel, singular);
}

void subtractOuterProduct(double* c, int ldc, const double* a, int lda, int n, int k) {
  MOTORCADE_KERNEL(subtractProduct)(c, ldc, a, lda, n, k);
}

void addJacobianProduct(const double* jacobian, int rows, int cols, double* h, int ldh) {
  MOTORCADE_KERNEL(addProductOf)(jacobian, rows, cols, h, ldh);
}

}  // namespace motorcade
#endif
