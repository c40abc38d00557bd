#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "core/se3.hpp"

/// Eigen's decompositions of the sizes that several rooms use. They are compiled once, in decompositions.cpp, as each
/// costs the compiler one to four seconds wherever it is instantiated. A source that decomposes such a matrix includes
/// this file.
namespace motorcade {

/// The inverse of a regular matrix, by a decomposition with pivots.
Matrix6d inverse(const Matrix6d& matrix);

/// The inverse of the matrix that was decomposed.
Matrix6d inverse(const Eigen::LLT<Matrix6d>& cholesky);

/// The eigenvalues of a symmetric matrix in rising order, and their unit vectors as columns.
struct SymmetricEigen {
  explicit SymmetricEigen(const Eigen::MatrixXd& matrix);

  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

}  // namespace motorcade

namespace Eigen {

extern template LLT<Matrix4d>& LLT<Matrix4d>::compute(const EigenBase<Matrix4d>&);
extern template void LLT<Matrix4d>::_solve_impl(const Vector4d&, Vector4d&) const;
extern template LLT<motorcade::Matrix6d>& LLT<motorcade::Matrix6d>::compute(const EigenBase<motorcade::Matrix6d>&);
extern template void LLT<motorcade::Matrix6d>::_solve_impl(const motorcade::Vector6d&, motorcade::Vector6d&) const;

}  // namespace Eigen
