#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "backend/graph/factor.hpp"
#include "backend/graph/linear_models.hpp"
#include "backend/graph/variable_states.hpp"

namespace motorcade {

/// Variables and factors of a least-squares problem, and which of them touch each other. Assigns their ids, and adds
/// and removes them together with the variables' states and the factors' linear models.
class FactorGraph {
 public:
  FactorGraph() = default;
  FactorGraph(const FactorGraph&) = delete;  // its parts refer to each other
  FactorGraph& operator=(const FactorGraph&) = delete;

  VariableId addVariable(const Value& initial);
  /// Removes a variable that has no factors any more.
  void removeVariable(VariableId id);
  /// Adds a factor. Returns nothing, and adds nothing, when it is not finite at its variables' present values.
  std::optional<FactorId> addFactor(AnyFactor factor);
  void removeFactor(FactorId id);

  const VariableStates& states() const { return states_; }
  VariableStates& states() { return states_; }
  const LinearModels& models() const { return models_; }
  LinearModels& models() { return models_; }

  std::span<const VariableId> variablesOf(FactorId id) const { return variables_of_[id.value]; }
  const std::vector<FactorId>& factorsOf(VariableId id) const { return nodes_[id.value].factors; }
  int sizeOf(VariableId id) const { return states_[id].size; }

  std::size_t slots() const { return nodes_.size(); }  // ids are below it
  std::size_t factorSlots() const { return variables_of_.size(); }
  std::size_t variableCount() const { return nodes_.size() - free_variables_.size(); }
  std::size_t factorCount() const { return variables_of_.size() - free_factors_.size(); }
  bool contains(FactorId id) const {
    return id.value >= 0 && static_cast<std::size_t>(id.value) < factorSlots() && !variablesOf(id).empty();
  }
  bool contains(VariableId id) const {
    return id.value >= 0 && static_cast<std::size_t>(id.value) < slots() && nodes_[id.value].alive;
  }
  /// All variables, and all factors, in ascending order of ids.
  std::vector<VariableId> variables() const;
  std::vector<FactorId> factors() const;

 private:
  struct Node {
    bool alive = false;
    std::vector<FactorId> factors;
  };

  std::vector<Node> nodes_;
  /// Variables per factor, empty where none is. They lie close to each other, as searches pass many factors.
  std::vector<std::span<const VariableId>> variables_of_;
  std::vector<VariableId> free_variables_;
  std::vector<FactorId> free_factors_;
  VariableStates states_;
  LinearModels models_{states_};
};

}  // namespace motorcade
