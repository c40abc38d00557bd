#pragma once

#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "backend/solver/incremental_solver.hpp"

namespace motorcade::test {

/// Thresholds at zero: the solver corrects and relinearizes whatever moved.
inline constexpr IncrementalSolver::Params kExact{
    .relinearization = {.mismatch_tolerance = 0, .jacobian_drift_sigmas = 0, .relinearize_rad = 0, .leisurely_rad = 0},
    .substitution_tolerance = 0,
    .budget = {}};

/// A^-1 B of a positive definite A, and A^-1 of a regular one.
Eigen::MatrixXd solved(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
Eigen::MatrixXd inverted(const Eigen::MatrixXd& A);

/// Dense Gauss-Newton over the factors of a graph, written independently of the solver.
class DenseSystem {
 public:
  /// Begins at the graph's estimates.
  explicit DenseSystem(const FactorGraph& graph);

  /// The information matrix at the present values, and the gradient.
  std::pair<Eigen::MatrixXd, Eigen::VectorXd> linearized() const;

  /// Robust losses converge linearly only, hence the many steps.
  void converge();

  /// Moves every value by `delta`, under right perturbations.
  void move(const Eigen::VectorXd& delta);

  int size() const { return size_; }
  int offset(VariableId v) const { return offset_[v.value]; }
  /// Rows of these variables.
  std::vector<int> entries(std::span<const VariableId> variables) const;
  const Value& value(VariableId v) const { return values_[v.value]; }

 private:
  const FactorGraph& graph_;
  std::vector<VariableId> variables_;
  std::vector<int> offset_;
  std::vector<Value> values_;
  int size_ = 0;
};

/// Updates until nothing moves any more.
void updateUntilStill(IncrementalSolver& solver);

/// Largest difference of a variable between the solver and a converged dense solution of its own graph. The latter
/// begins `nudge` (standard deviation of each component) beside the solver's, and so leaves a stationary point that is
/// no minimum.
double differenceFromBatch(const IncrementalSolver& solver, double nudge = 0.01);

}  // namespace motorcade::test
