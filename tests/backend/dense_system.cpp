#include "tests/backend/dense_system.hpp"

#include <algorithm>
#include <cstdint>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "tests/backend/perturbation.hpp"
#include "tests/support/noise.hpp"

namespace motorcade::test {
namespace {

/// Turns a quadratic in steps along the world's axes into one in right perturbations.
Eigen::MatrixXd turned(std::span<const Value* const> values, const Eigen::MatrixXd& quadratic) {
  Eigen::MatrixXd by_perturbation = Eigen::MatrixXd::Identity(quadratic.rows(), quadratic.cols());
  Eigen::Index at = 0;
  for (const Value* value : values) {
    if (const auto* pose = std::get_if<SE3>(value))
      by_perturbation.block<3, 3>(at, at) = by_perturbation.block<3, 3>(at + 3, at + 3) = pose->rotation();
    if (const auto* pose = std::get_if<SE2>(value)) by_perturbation.block<2, 2>(at, at) = pose->rotation();
    at += dimension(*value);
  }
  return by_perturbation.transpose() * quadratic * by_perturbation;
}

}  // namespace

Eigen::MatrixXd solved(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) { return A.llt().solve(B); }
Eigen::MatrixXd inverted(const Eigen::MatrixXd& A) { return A.inverse(); }

DenseSystem::DenseSystem(const FactorGraph& graph)
    : graph_(graph), variables_(graph.variables()), offset_(graph.slots()), values_(graph.slots()) {
  for (const VariableId v : variables_) {
    offset_[v.value] = size_;
    size_ += graph.sizeOf(v);
    values_[v.value] = graph.states().estimate(v);
  }
}

std::pair<Eigen::MatrixXd, Eigen::VectorXd> DenseSystem::linearized() const {
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size_, size_);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(size_);
  for (const FactorId f : graph_.factors()) {
    const Factor& factor = graph_.models().factor(f);
    std::vector<const Value*> values;
    for (const VariableId v : factor.variables()) values.push_back(&values_[v.value]);
    const auto at = entries(factor.variables());
    const auto n = static_cast<Eigen::Index>(at.size());
    Eigen::MatrixXd quadratic(factor.rows(), n + 1);
    factor.linearize(values, quadratic);
    if (graph_.models().isJacobian(f)) quadratic = (quadratic.transpose() * quadratic).eval();
    quadratic.triangularView<Eigen::StrictlyUpper>() = quadratic.transpose();
    if (!graph_.models().isJacobian(f)) quadratic = turned(values, quadratic);
    H(at, at) += quadratic.topLeftCorner(n, n);
    g(at) += quadratic.col(n).head(n);
  }
  return {H, g};
}

void DenseSystem::converge() {
  for (int i = 0; i < 500; ++i) {
    const auto [H, g] = linearized();
    const Eigen::VectorXd delta = -H.ldlt().solve(g);
    move(delta);
    if (delta.cwiseAbs().maxCoeff() < 1e-12) return;
  }
}

void DenseSystem::move(const Eigen::VectorXd& delta) {
  for (const VariableId v : variables_)
    values_[v.value] = retract(value(v), delta.segment(offset(v), graph_.sizeOf(v)));
}

std::vector<int> DenseSystem::entries(std::span<const VariableId> variables) const {
  std::vector<int> at;
  for (const VariableId v : variables)
    for (int i = 0; i < graph_.sizeOf(v); ++i) at.push_back(offset(v) + i);
  return at;
}

void updateUntilStill(IncrementalSolver& solver) {
  for (int i = 0; i < 200; ++i)
    if (solver.update().largest_change < 1e-11) return;
}

double differenceFromBatch(const IncrementalSolver& solver, double nudge) {
  DenseSystem dense(solver.graph());
  Noise noise(static_cast<std::uint64_t>(dense.size()));
  Eigen::VectorXd delta(dense.size());
  for (double& d : delta) d = noise.gaussian(nudge);
  dense.move(delta);
  dense.converge();
  double largest = 0;
  for (const VariableId v : solver.graph().variables())
    largest = std::max(largest, local(dense.value(v), solver.estimate(v)).norm());
  return largest;
}

}  // namespace motorcade::test
