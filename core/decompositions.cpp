#include "core/decompositions.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace motorcade {

Matrix6d inverse(const Matrix6d& matrix) { return matrix.inverse(); }

Matrix6d inverse(const Eigen::LLT<Matrix6d>& cholesky) { return cholesky.solve(Matrix6d::Identity()); }

SymmetricEigen::SymmetricEigen(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  values = solver.eigenvalues();
  vectors = solver.eigenvectors();
}

}  // namespace motorcade

namespace Eigen {

template LLT<Matrix4d>& LLT<Matrix4d>::compute(const EigenBase<Matrix4d>&);
template void LLT<Matrix4d>::_solve_impl(const Vector4d&, Vector4d&) const;
template LLT<motorcade::Matrix6d>& LLT<motorcade::Matrix6d>::compute(const EigenBase<motorcade::Matrix6d>&);
template void LLT<motorcade::Matrix6d>::_solve_impl(const motorcade::Vector6d&, motorcade::Vector6d&) const;

}  // namespace Eigen
