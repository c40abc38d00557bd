#pragma once

namespace motorcade {

/// y += A x with a symmetric matrix A, of n x n and column-major. What is above its diagonal is not read, nor is what
/// pads the columns of `lda` numbers.
void addSymmetricProduct(const double* a, int lda, int n, const double* x, double* y);

}  // namespace motorcade
