#include "backend/graph/marginal_factor.hpp"

#include <algorithm>

#include "core/decompositions.hpp"

namespace motorcade {
namespace {

/// Pseudo-inverse of a symmetric positive semidefinite matrix.
Eigen::MatrixXd pseudoInverse(const Eigen::MatrixXd& matrix) {
  const SymmetricEigen eigen(matrix);
  Eigen::VectorXd inverse = eigen.values;
  const double smallest = 1e-12 * std::max(inverse.maxCoeff(), 1e-300);
  for (auto& value : inverse) value = value > smallest ? 1.0 / value : 0.0;
  return eigen.vectors * inverse.asDiagonal() * eigen.vectors.transpose();
}

/// Jacobian of the turn of a displacement to a pose, under a step of that pose.
Eigen::Matrix3d turnJacobian(const Eigen::Vector3d& turn_rad) {
  // log(exp(d) * exp(phi)) ~ phi + Jl^-1(phi) d, Jl^-1(phi) = Jr^-1(-phi).
  Vector6d minus = Vector6d::Zero();
  minus.tail<3>() = -turn_rad;
  return rightJacobianInverseSE3(minus).bottomRightCorner<3, 3>();
}

}  // namespace

MarginalFactor::MarginalFactor(std::vector<VariableId> variables, std::vector<Value> values,
                               Eigen::MatrixXd information)
    : InformationFactor(std::move(variables), static_cast<int>(information.rows())),
      values_(std::move(values)),
      information_(std::move(information)) {
  information_.triangularView<Eigen::StrictlyUpper>() = information_.transpose();
}

void MarginalFactor::linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const {
  // e(delta) ~ e + J delta, so [H g; g^T c] -> T^T [H g; g^T c] T with T = [J e; 0 1].
  const Eigen::Index n = information_.rows() - 1;
  Eigen::VectorXd e(n);
  term = information_;
  Eigen::Index at = 0;
  for (std::size_t k = 0; k < values_.size(); ++k) {
    const SmallVector move = displacement(values_[k], *values[k]);
    e.segment(at, move.size()) = move;
    at += move.size();
  }
  const Eigen::VectorXd shift = information_.topLeftCorner(n, n) * e;
  term(n, n) += e.dot(shift) + 2 * e.dot(information_.col(n).head(n));
  term.row(n).head(n) += shift.transpose();
  at = 0;
  for (const Value& value : values_) {
    if (std::holds_alternative<SE3>(value)) {
      const Eigen::Matrix3d J = turnJacobian(e.segment<3>(at + 3));
      term.middleCols<3>(at + 3) = (term.middleCols<3>(at + 3) * J).eval();
      term.middleRows<3>(at + 3) = (J.transpose() * term.middleRows<3>(at + 3)).eval();
    }
    at += dimension(value);
  }
}

std::unique_ptr<InformationFactor> MarginalFactor::without(std::span<const VariableId> gone) const {
  std::vector<Eigen::Index> kept, removed;
  std::vector<VariableId> variables_left;
  std::vector<Value> values_left;
  Eigen::Index at = 0;
  for (std::size_t k = 0; k < values_.size(); ++k) {
    const bool leaves = std::ranges::find(gone, variables()[k]) != gone.end();
    for (int i = 0; i < dimension(values_[k]); ++i) (leaves ? removed : kept).push_back(at++);
    if (leaves) continue;
    variables_left.push_back(variables()[k]);
    values_left.push_back(values_[k]);
  }
  if (variables_left.empty()) return nullptr;
  kept.push_back(at);
  const Eigen::MatrixXd coupling = information_(removed, kept);
  Eigen::MatrixXd information = information_(kept, kept);
  information -= coupling.transpose() * pseudoInverse(information_(removed, removed)) * coupling;
  return std::make_unique<MarginalFactor>(std::move(variables_left), std::move(values_left), std::move(information));
}

}  // namespace motorcade
