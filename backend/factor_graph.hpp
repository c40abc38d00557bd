#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "backend/factor.hpp"

namespace motorcade {

/// A factor near its linearisation point, in the factor's form.
struct LinearTerm {
  Factor::Form form = Factor::Form::kJacobian;
  Eigen::MatrixXd matrix;
};

/// The variables and factors of a least-squares problem, with each factor linearised at its variables' linearisation points.
class FactorGraph {
 public:
  struct Variable {
    Value linearization_point;
    SmallVector delta;  // solution relative to the linearisation point
    std::vector<FactorId> factors;
    bool alive = false;
  };

  VariableId addVariable(const Value& initial);
  /// The variable must have no factors any more.
  void removeVariable(VariableId id);

  /// Empty, and nothing is added, when the factor is not finite at its variables' present values.
  std::optional<FactorId> addFactor(std::unique_ptr<const Factor> factor);
  void removeFactor(FactorId id);

  /// Moves the linearisation point by delta. Linearise the factors of the variable anew after that.
  void moveToEstimate(VariableId id);
  /// Keeps the former linearisation if the new one is not finite.
  void linearize(FactorId id);

  const Variable& operator[](VariableId id) const { return variables_[static_cast<std::size_t>(id.value)]; }
  Variable& operator[](VariableId id) { return variables_[static_cast<std::size_t>(id.value)]; }
  const Factor& factor(FactorId id) const { return *factors_[static_cast<std::size_t>(id.value)].factor; }
  const LinearTerm& term(FactorId id) const { return factors_[static_cast<std::size_t>(id.value)].term; }

  int sizeOf(VariableId id) const { return static_cast<int>((*this)[id].delta.size()); }
  Value estimate(VariableId id) const { return retract((*this)[id].linearization_point, (*this)[id].delta); }

  std::size_t slots() const { return variables_.size(); }  // ids are below it
  std::size_t variableCount() const { return variables_.size() - free_variables_.size(); }
  std::size_t factorCount() const { return factors_.size() - free_factors_.size(); }
  /// In ascending order of ids.
  std::vector<VariableId> variables() const;
  std::vector<FactorId> factors() const;

 private:
  struct LinearizedFactor {
    std::unique_ptr<const Factor> factor;
    LinearTerm term;
  };
  LinearTerm linearized(const Factor& factor) const;

  std::vector<Variable> variables_;
  std::vector<LinearizedFactor> factors_;
  std::vector<VariableId> free_variables_;
  std::vector<FactorId> free_factors_;
};

}  // namespace motorcade
