#pragma once

#include <array>
#include <memory>

#include "backend/graph/factor.hpp"

namespace motorcade {

/// A factor on two variables of one kind, of which one is held constant: a factor on the other one remains.
class HeldEndFactor final : public JacobianFactor {
 public:
  enum class Held { kFirst, kSecond };
  /// `other` is the variable that is left.
  HeldEndFactor(std::unique_ptr<const JacobianFactor> factor, Held held, Value value, VariableId other);
  void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const override;
  void residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const override;

 private:
  std::array<const Value*, 2> both(std::span<const Value* const> values) const;

  std::unique_ptr<const JacobianFactor> factor_;
  Held held_;
  Value value_;
};

}  // namespace motorcade
