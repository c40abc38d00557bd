#include "backend/elimination/front_sums.hpp"

#include <algorithm>

#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "backend/elimination/front_sums.cpp"
#include <hwy/foreach_target.h>

#include "backend/graph/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

typedef double Pair __attribute__((vector_size(16)));  // NOLINT(modernize-use-using): the attribute belongs to it

/// Three or six numbers, as poses have, are added without a loop.
HWY_INLINE void addPair(double* to, const double* from) {
  Pair sum, term;
  __builtin_memcpy(&sum, to, sizeof(Pair));
  __builtin_memcpy(&term, from, sizeof(Pair));
  sum += term;
  __builtin_memcpy(to, &sum, sizeof(Pair));
}
HWY_INLINE void addTo(double* to, const double* from, int count) {
  int i = 0;
  for (; i + kLanes <= count; i += kLanes) store(to + i, load(to + i) + load(from + i));
  if (count & 2) addPair(to + i, from + i), i += 2;
  if (count & 1) to[i] += from[i];
}

/// A column of a matrix, indexed by row, and the way to those after it.
struct Column {
  const double* at;
  int step, shrinks;  // numbers to the next column; one less each time where the matrix is packed

  HWY_INLINE void next() { at += step, step -= shrinks; }
};

/// A block of a matrix: rows below the diagonal, of columns from `column` on.
template <int kRows>
HWY_INLINE void addBlock(const FrontColumns& front, Column column, const RowSpan& columns, const RowSpan& rows) {
  const int count = kRows > 0 ? kRows : rows.size, stride = front.strideAt(columns.to);
  double* to = front[columns.to] + rows.to;
  for (int j = 0; j < columns.size; ++j, to += stride, column.next()) addTo(to, column.at + rows.from, count);
}
/// The same where it lies above the front's diagonal, so that its transpose is added.
HWY_INLINE void addTransposed(const FrontColumns& front, Column column, const RowSpan& columns, const RowSpan& rows) {
  const int stride = front.strideAt(rows.to);
  double* const first = front[rows.to] + columns.to;
  for (int j = 0; j < columns.size; ++j, column.next()) {
    const double* const from = column.at + rows.from;
    double* to = first + j;
    for (int i = 0; i < rows.size; ++i, to += stride) *to += from[i];
  }
}
/// A block on the diagonal, of which the lower triangle counts.
HWY_INLINE void addDiagonal(const FrontColumns& front, Column column, const RowSpan& columns) {
  const int stride = front.strideAt(columns.to);
  double* to = front[columns.to] + columns.to;
  for (int j = 0; j < columns.size; ++j, to += stride + 1, column.next())
    addTo(to, column.at + columns.from + j, columns.size - j);
}

/// `column_of` gives the matrix's columns.
template <class ColumnOf>
HWY_INLINE void addSymmetric(const FrontColumns& front, const ColumnOf& column_of, std::span<const RowSpan> spans) {
  for (std::size_t b = 0; b < spans.size(); ++b) {
    const RowSpan columns = spans[b];
    const Column first = column_of(columns.from);
    addDiagonal(front, first, columns);
    for (const RowSpan& rows : spans.subspan(b + 1)) {
      if (rows.to < columns.to)
        addTransposed(front, first, columns, rows);
      else if (rows.size == 3)
        addBlock<3>(front, first, columns, rows);
      else if (rows.size == 6)
        addBlock<6>(front, first, columns, rows);
      else
        addBlock<0>(front, first, columns, rows);
    }
  }
}

/// Rows of J^T J that belong to a variable of three or six scalars, of J with K rows. Six are two vectors that overlap.
template <int K, int kSize>
struct RowsOfSquare {
  static constexpr int kVecs = kSize / 3;
  Vec transposed[kVecs][K];

  HWY_INLINE explicit RowsOfSquare(const double* J) {
#pragma GCC unroll 2
    for (int v = 0; v < kVecs; ++v, J += 2 * K)
#pragma GCC unroll 12
      for (int k = 0; k < K; ++k)
        transposed[v][k] = four(J[k], J[k + K], J[k + 2 * K], kSize == 3 ? 0.0 : J[k + 3 * K]);
  }
  /// The rows' products with a column of J.
  HWY_INLINE void multiply(const double* column, Vec (&sums)[kVecs]) const {
#pragma GCC unroll 2
    for (int v = 0; v < kVecs; ++v) {
      sums[v] = transposed[v][0] * broadcast(column[0]);
#pragma GCC unroll 12
      for (int k = 1; k < K; ++k) sums[v] += transposed[v][k] * broadcast(column[k]);
    }
  }
  /// Adds them to a column of the front. Below a variable of three scalars there is at least one more row.
  HWY_INLINE void addTo(double* to, const double* column) const {
    Vec sums[kVecs];
    multiply(column, sums);
#pragma GCC unroll 2
    for (int v = 0; v < kVecs; ++v) sums[v] = load(to + 2 * v) + sums[v];
#pragma GCC unroll 2
    for (int v = 0; v < kVecs; ++v) store(to + 2 * v, sums[v]);
  }
};

/// Adds the rows of J^T J at `spans[at]`, up to the diagonal, and their right-hand side.
template <int K, int kSize>
void addRowsOfSquare(const FrontColumns& front, const double* J, std::span<const RowSpan> spans, std::size_t at) {
  const RowSpan rows = spans[at], last = spans.back();
  const RowsOfSquare<K, kSize> square(J + rows.from * K);
  for (const RowSpan& columns : spans.first(at + 1)) {
    const int stride = front.strideAt(columns.to);
    double* to = front[columns.to] + rows.to;
    const double* column = J + columns.from * K;
    for (int j = 0; j < columns.size; ++j, to += stride, column += K) square.addTo(to, column);
  }
  double g[6];
  Vec sums[kSize / 3];
  square.multiply(J + last.from * K, sums);
#pragma GCC unroll 2
  for (int v = 0; v < kSize / 3; ++v) store(g + 2 * v, sums[v]);
  const int stride = front.strideAt(rows.to);
  double* to = front[rows.to] + last.to;
  for (int i = 0; i < kSize; ++i, to += stride) *to += g[i];
}

template <int K>
void addSquareOf(const FrontColumns& front, const double* J, std::span<const RowSpan> spans) {
  for (std::size_t at = 0; at + 1 < spans.size(); ++at)
    spans[at].size == 3 ? addRowsOfSquare<K, 3>(front, J, spans, at) : addRowsOfSquare<K, 6>(front, J, spans, at);
  const RowSpan last = spans.back();
  const double* const r = J + last.from * K;
  double squared = 0;
  for (int k = 0; k < K; ++k) squared += r[k] * r[k];
  front[last.to][last.to] += squared;
}

}  // namespace

/// The value is an argument, as the compiler would call the C library for each column to store a constant.
void fillTriangle(double* matrix, int stride, int columns, double value) {
  for (int j = 0; j < columns; ++j, matrix += stride)
    for (int i = j / kLanes * kLanes; i < stride; i += kLanes) store(matrix + i, broadcast(value));
}

void addPacked(const FrontColumns& front, const PackedTriangle& matrix, std::span<const RowSpan> spans) {
  addSymmetric(
      front,
      [&](int j) HWY_ATTR {
        return Column{matrix.column(j), matrix.size - j - 1, 1};
      },
      spans);
}

void addStrided(const FrontColumns& front, const double* matrix, int stride, std::span<const RowSpan> spans) {
  addSymmetric(
      front,
      [=](int j) HWY_ATTR {
        return Column{matrix + std::ptrdiff_t(j) * stride, stride, 0};
      },
      spans);
}

void addSquare(const FrontColumns& front, const double* J, int rows, std::span<const RowSpan> spans) {
  if (rows == 3) return addSquareOf<3>(front, J, spans);
  if (rows == 6) return addSquareOf<6>(front, J, spans);
  addSquareOf<12>(front, J, spans);
}

void packTriangle(const double* matrix, int stride, int size, double* packed) {
  for (int j = 0; j < size; ++j, matrix += stride + 1) {
    const int count = size - j;
    int i = 0;
    for (; i + kLanes <= count; i += kLanes) store(packed + i, load(matrix + i));
    for (; i < count; ++i) packed[i] = matrix[i];
    packed += count;
  }
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(fillTriangle);
MOTORCADE_EXPORT(addPacked);
MOTORCADE_EXPORT(addStrided);
MOTORCADE_EXPORT(addSquare);
MOTORCADE_EXPORT(packTriangle);

void clearLowerTriangle(double* matrix, int stride, int columns) {
  MOTORCADE_KERNEL(fillTriangle)(matrix, stride, columns, 0.0);
}

void addToFront(const FrontColumns& front, const PackedTriangle& matrix, std::span<const RowSpan> spans) {
  MOTORCADE_KERNEL(addPacked)(front, matrix, spans);
}

void addToFront(const FrontColumns& front, const double* matrix, int stride, std::span<const RowSpan> spans) {
  MOTORCADE_KERNEL(addStrided)(front, matrix, stride, spans);
}

bool addSquareToFront(const FrontColumns& front, const double* jacobian, int rows, std::span<const RowSpan> spans) {
  const auto isPose = [](const RowSpan& span) { return span.size == 3 || span.size == 6; };
  if ((rows != 3 && rows != 6 && rows != 12) || !std::all_of(spans.begin(), spans.end() - 1, isPose)) return false;
  MOTORCADE_KERNEL(addSquare)(front, jacobian, rows, spans);
  return true;
}

void packLowerTriangle(const double* matrix, int stride, int size, double* packed) {
  MOTORCADE_KERNEL(packTriangle)(matrix, stride, size, packed);
}

}  // namespace motorcade
#endif
