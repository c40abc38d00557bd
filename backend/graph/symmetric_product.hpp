#pragma once

#include "backend/graph/packed_triangle.hpp"

namespace motorcade {

/// y += A x with a symmetric matrix A.
void addSymmetricProduct(const PackedTriangle& a, const double* x, double* y);

}  // namespace motorcade
