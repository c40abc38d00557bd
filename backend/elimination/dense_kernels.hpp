#pragma once

#include <vector>

namespace motorcade {

/// Dense kernels for the elimination of one clique. A `panel` gathers the information of the clique's variables, and
/// elimination turns it into the clique's rows of R, transposed. An outer product of the panel's lower rows passes the
/// rest to the parent.
///
/// Matrices are column-major. A leading dimension (`ld...`) is a multiple of 4 and at least the number of rows. The
/// rows that pad it belong to the buffer, hold anything, and are written to, as is the strictly upper triangle within 4
/// x 4 blocks on the diagonal; neither is ever read for a result. Buffers need no alignment beyond a double's. Nothing
/// outside of ld * columns is touched, and nothing is allocated. Large matrices are slower when ld is a multiple of
/// 512, as their columns compete for the same cache lines.

/// The leading dimension for so many rows.
constexpr int padded(int rows) { return (rows + 3) / 4 * 4; }

/// A panel in memory. Its leading columns x columns block belongs to the eliminated scalars (lower triangle); below lie
/// the couplings to the separator and, in the last row, the right-hand side.
struct Panel {
  double* data;
  int ld, rows, columns;
};

/// A pivot is singular when not above this times its diagonal entry before elimination: rounding leaves about 1e-16.
constexpr double kSingularPivot = 1e-13;

/// Factorizes a panel of information in place: [H11; H21; g^T] becomes [L11; L21; d^T].
///
/// A singular pivot, or one that is not finite, becomes 1 and the column below it zero, so that the scalar's delta is
/// zero; its index is appended to `singular`. Returns the smallest ratio of any other pivot to its diagonal entry
/// before elimination, at most 1.
double factorizePanel(const Panel& panel, std::vector<int>& singular);

/// C -= A A^T, lower triangle. A is n x k and may be the lower rows of a panel; nothing past the panel's end is read.
void subtractOuterProduct(double* c, int ldc, const double* a, int lda, int n, int k);

/// H += J^T J, lower triangle, of cols x cols. J is rows x cols without padding.
void addJacobianProduct(const double* jacobian, int rows, int cols, double* h, int ldh);

}  // namespace motorcade
