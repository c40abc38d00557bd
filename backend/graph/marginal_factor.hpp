#pragma once

#include <memory>

#include "backend/graph/factor.hpp"

namespace motorcade {

/// Information of retired variables on those that stay: a quadratic around the values at that moment. When a variable's
/// linearization point moves later, the quadratic stays the same function of e = displacement(value then, value now).
class MarginalFactor final : public InformationFactor {
 public:
  /// `information` is the lower triangle of [H g; g^T c] over the stacked deltas from `values`.
  MarginalFactor(std::vector<VariableId> variables, std::vector<Value> values, Eigen::MatrixXd information);

  void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const override;

  /// Marginalizes the variables that go.
  std::unique_ptr<InformationFactor> without(std::span<const VariableId> gone) const override;

 private:
  std::vector<Value> values_;
  Eigen::MatrixXd information_;  // full symmetric
};

}  // namespace motorcade
