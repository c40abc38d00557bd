#pragma once

#include <cstddef>
#include <span>

#include "backend/graph/packed_triangle.hpp"

namespace motorcade {

/// A front's lower triangle in memory: the columns of the panel, then those of the update matrix. The strides are the
/// leading dimensions.
struct FrontColumns {
  double* panel;
  int panel_stride, panel_columns;
  double* update_matrix;
  int update_stride;

  /// A column, indexed by rows of the front from the diagonal on.
  double* operator[](int column) const {
    if (column < panel_columns) return panel + std::ptrdiff_t(column) * panel_stride;
    return update_matrix + std::ptrdiff_t(column - panel_columns) * update_stride - panel_columns;
  }
  /// Numbers from a column to the next one on the same side of the border.
  int strideAt(int column) const { return column < panel_columns ? panel_stride : update_stride; }
};

/// Rows of a small symmetric matrix, from `from` on, that are rows of a front from `to` on.
struct RowSpan {
  int from, to, size;
};

/// Clears the lower triangle of a matrix, and the 4 x 4 blocks on the diagonal whole, as the dense kernels read them.
/// The stride is a multiple of 4.
void clearLowerTriangle(double* matrix, int stride, int columns);

/// Adds a small symmetric matrix, of which the lower triangle is read, to the front's lower triangle. The spans say
/// where its rows are, in ascending order of `from`; none crosses the border between panel and update matrix.
void addToFront(const FrontColumns& front, const PackedTriangle& matrix, std::span<const RowSpan> spans);
/// The same for a matrix with `stride` numbers from column to column.
void addToFront(const FrontColumns& front, const double* matrix, int stride, std::span<const RowSpan> spans);
/// Adds [J r]^T [J r] of a Jacobian without padding. The spans are those of its columns, in ascending order of `to`,
/// with the residual in the front's last row. Writes above the front's diagonal, too. Returns false, and adds nothing,
/// unless the variables have 3 or 6 scalars and J has 3, 6 or 12 rows. The sums are rounded as addJacobianProduct does.
bool addSquareToFront(const FrontColumns& front, const double* jacobian, int rows, std::span<const RowSpan> spans);

/// Copies the lower triangle of a matrix into a packed one.
void packLowerTriangle(const double* matrix, int stride, int size, double* packed);

}  // namespace motorcade
