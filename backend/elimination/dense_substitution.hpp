#pragma once

#include <span>

#include "backend/elimination/dense_kernels.hpp"

namespace motorcade {

/// Solutions with a factorized panel [L11; L21; d^T]; what dense_kernels.hpp says of memory holds here too.

/// Solves L11^T x_frontal = -(d + L21^T x_separator), with d in the panel's last row.
void backSubstitute(const Panel& panel, const double* x_separator, double* x_frontal);

/// Eliminates with a new right-hand side g of rows - 1 entries, frontal ones first: d = L11^-1 g1 replaces g1 and the
/// panel's last row, and g2 -= L21 d. The d of the `singular` scalars that the factorization found is zero.
void forwardSubstitute(const Panel& panel, std::span<const int> singular, double* g);

/// Eliminates several right-hand sides, and leaves the panel as it is. Each scalar has one row of `y` with `stride`
/// numbers, a multiple of 4; the panel's last row has none. Y1 = L11^-1 G1 replaces the upper rows, and G2 - L21 Y1 the
/// lower ones. No scalar is singular.
void forwardSubstitute(const Panel& panel, double* y, int stride);

}  // namespace motorcade
