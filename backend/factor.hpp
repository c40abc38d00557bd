#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "backend/variable.hpp"

namespace motorcade {

/// A factor near its linearisation point, as a quadratic in the stacked deltas of its variables.
struct LinearTerm {
  enum class Form {
    kJacobian,     // [J | r], whitened: cost |J delta + r|^2
    kInformation,  // lower triangle of the symmetric [H g; g^T c]: cost delta^T H delta + 2 g^T delta + c
  };
  Form form = Form::kJacobian;
  Eigen::MatrixXd matrix;
};

/// A term of the least-squares problem over a few variables.
class Factor {
 public:
  explicit Factor(std::vector<VariableId> variables) : variables_(std::move(variables)) {}
  Factor(const Factor&) = delete;
  Factor& operator=(const Factor&) = delete;
  virtual ~Factor() = default;

  std::span<const VariableId> variables() const { return variables_; }

  /// At `values`, one per variable in their order. A robust loss weights the term (iteratively reweighted least squares).
  virtual void linearize(std::span<const Value* const> values, LinearTerm& term) const = 0;

 private:
  std::vector<VariableId> variables_;
};

}  // namespace motorcade
