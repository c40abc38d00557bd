#pragma once

#include "backend/elimination/dense_kernels.hpp"

namespace motorcade {

/// Adds `count` rows W to a factor in place: its rows R become R' with R'^T R' = R^T R + W^T W. Costs the panel's area
/// times the count, where an elimination costs the area times the panel's columns.
///
/// `w` holds W^T with the panel's leading dimension, so a column for each row. What W says about scalars before `first`
/// is zero. W is used up.
void addRows(const Panel& panel, int first, double* w, int count);

/// Adds an outer product to a symmetric matrix and puts new rows before it: to = [0 0; 0 from] + W^T W. Both are packed
/// triangles, `to` of `size` rows and `from` of `count` fewer; both may begin at the same place. `w` holds W^T, a
/// column of `ld` numbers for each row.
void growByProduct(double* to, int size, const double* from, const double* w, int ld, int count);

}  // namespace motorcade
