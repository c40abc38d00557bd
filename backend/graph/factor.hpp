#pragma once

#include <memory>
#include <span>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "backend/graph/packed_triangle.hpp"
#include "backend/graph/variable.hpp"

namespace motorcade {

/// A term of the least-squares problem over a few variables. JacobianFactor and InformationFactor state the quadratic
/// in the variables' stacked deltas in different ways.
class Factor {
 public:
  Factor(const Factor&) = delete;
  Factor& operator=(const Factor&) = delete;
  virtual ~Factor() = default;

  std::span<const VariableId> variables() const { return variables_; }
  /// Number of rows of the matrix that `linearize` fills.
  int rows() const { return rows_; }

  /// Linearizes at `values`, one per variable in their order. Fills rows() x (sum of dimensions + 1); the last column
  /// is the right-hand side. A robust loss weights the term (iteratively reweighted least squares).
  virtual void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const = 0;

 protected:
  Factor(std::vector<VariableId> variables, int rows) : variables_(std::move(variables)), rows_(rows) {}

 private:
  std::vector<VariableId> variables_;
  int rows_;
};

/// Linearized as [J | r], whitened, under right perturbations: cost |J delta + r|^2.
class JacobianFactor : public Factor {
 public:
  /// Computes the last column of `linearize`, the whitened and weighted residual, without the Jacobian's cost.
  virtual void residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const = 0;

 protected:
  using Factor::Factor;
};

/// Linearized as the lower triangle of symmetric [H g; g^T c], by steps in the world's axes (see `displaced`): cost
/// delta^T H delta + 2 g^T delta + c, exact in its vectors.
class InformationFactor : public Factor {
 public:
  /// Computes g and c of `linearize`, stacked, without H where that is possible.
  virtual void gradient(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> g_c) const {
    Eigen::MatrixXd term(rows(), rows());
    linearize(values, term);
    g_c = term.row(rows() - 1);
  }

  /// The factor's own model, if it equals the result of `linearize` at these `values`; else null. It lasts as long as
  /// the factor.
  virtual const Quadratic* heldModel(std::span<const Value* const>) const { return nullptr; }

  /// A factor with the information that remains when variables go; null when none does.
  virtual std::unique_ptr<InformationFactor> without(std::span<const VariableId>) const { return nullptr; }

 protected:
  using Factor::Factor;
};

using AnyFactor = std::variant<std::unique_ptr<const JacobianFactor>, std::unique_ptr<const InformationFactor>>;

}  // namespace motorcade
