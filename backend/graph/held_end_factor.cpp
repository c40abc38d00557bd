#include "backend/graph/held_end_factor.hpp"

#include <cassert>
#include <utility>

namespace motorcade {

HeldEndFactor::HeldEndFactor(std::unique_ptr<const JacobianFactor> factor, Held held, Value value, VariableId other)
    : JacobianFactor({other}, factor->rows()), factor_(std::move(factor)), held_(held), value_(std::move(value)) {
  assert(factor_->variables().size() == 2);
}

std::array<const Value*, 2> HeldEndFactor::both(std::span<const Value* const> values) const {
  if (held_ == Held::kFirst) return {&value_, values[0]};
  return {values[0], &value_};
}

/// Leaves the constant's columns out.
void HeldEndFactor::linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const {
  const Eigen::Index n = dimension(value_);
  Eigen::MatrixXd whole(rows(), 2 * n + 1);
  factor_->linearize(both(values), whole);
  term.leftCols(n) = whole.middleCols(held_ == Held::kFirst ? n : 0, n);
  term.col(n) = whole.col(2 * n);
}

void HeldEndFactor::residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const {
  factor_->residual(both(values), r);
}

}  // namespace motorcade
