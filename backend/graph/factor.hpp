#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "backend/graph/packed_triangle.hpp"
#include "backend/graph/variable.hpp"

namespace motorcade {

/// A term of the least-squares problem over a few variables.
class Factor {
 public:
  /// How `linearize` states the quadratic in the stacked deltas of the variables, in a matrix with a last column for
  /// the right-hand side.
  enum class Form {
    kJacobian,     // [J | r], whitened: cost |J delta + r|^2
    kInformation,  // lower triangle of symmetric [H g; g^T c]: cost delta^T H delta + 2 g^T delta + c, exact in its
                   // vectors
  };

  /// `rows` of the matrix that `linearize` fills.
  Factor(std::vector<VariableId> variables, Form form, int rows)
      : variables_(std::move(variables)), form_(form), rows_(rows) {}
  Factor(const Factor&) = delete;
  Factor& operator=(const Factor&) = delete;
  virtual ~Factor() = default;

  std::span<const VariableId> variables() const { return variables_; }
  Form form() const { return form_; }
  int rows() const { return rows_; }

  /// At `values`, one per variable in their order: of Form::kJacobian under right perturbations, of Form::kInformation
  /// by steps in the world's axes (see `displaced`). A robust loss weights the term (iteratively reweighted least
  /// squares). Fills rows() x (sum of dimensions + 1), of information the lower triangle.
  virtual void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const = 0;

  /// Of Form::kJacobian only: the last column of `linearize`, the whitened and weighted residual, without the
  /// Jacobian's cost.
  virtual void residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const = 0;

  /// Of Form::kInformation only: g and c of `linearize`, stacked, where they can be had without H.
  virtual void gradient(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> g_c) const {
    Eigen::MatrixXd term(rows_, rows_);
    linearize(values, term);
    g_c = term.row(rows_ - 1);
  }

  /// Of Form::kInformation only: where `values` are those for which the factor was made, what it holds is what
  /// `linearize` gives; null elsewhere. It lasts as long as the factor.
  virtual const Quadratic* heldModel(std::span<const Value* const>) const { return nullptr; }

 private:
  std::vector<VariableId> variables_;
  Form form_;
  int rows_;
};

}  // namespace motorcade
