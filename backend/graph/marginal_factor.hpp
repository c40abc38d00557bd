#pragma once

#include <memory>

#include "backend/graph/factor.hpp"

namespace motorcade {

/// What retired variables said about those that stay: a quadratic around the values at that moment. When a variable's
/// linearization point moves later, the quadratic stays the same function of e = local(value then, value now).
class MarginalFactor final : public Factor {
 public:
  /// `information` is the lower triangle of [H g; g^T c] over the stacked deltas from `values`.
  MarginalFactor(std::vector<VariableId> variables, std::vector<Value> values, Eigen::MatrixXd information);

  void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const override;
  void residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const override;

  /// The same knowledge without `gone`, which are marginalized; empty when nothing is left.
  std::unique_ptr<MarginalFactor> without(std::span<const VariableId> gone) const;

 private:
  std::vector<Value> values_;
  Eigen::MatrixXd information_;  // full symmetric
};

}  // namespace motorcade
