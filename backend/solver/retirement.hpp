#pragma once

#include <span>
#include <vector>

#include "backend/elimination/eliminator.hpp"

namespace motorcade {

/// Removes variables from the solver: marginalized when they are old, dropped when they went wrong. Both need a tree
/// that holds all variables and factors of the graph.
class Retirement {
 public:
  Retirement(FactorGraph& graph, EliminationTree& tree, Eliminator& eliminator)
      : graph_(graph), tree_(tree), eliminator_(eliminator) {}

  /// Marginalizes the variables: their information stays as a factor on their neighbors, and the solution does not
  /// change.
  void marginalize(std::span<const VariableId> variables);
  /// Removes the variables and all measurements of them. Returns the cliques that were eliminated anew, up to the
  /// roots, whose solution changes; they last until the next call.
  std::span<const int> drop(std::span<const VariableId> variables);

 private:
  /// A connected part of the tree whose cliques hold variables that retire. A change of order inside leaves what it
  /// passes to its parent unchanged, so retiring costs only this part, wherever it lies.
  struct Part {
    std::vector<int> cliques;
    std::vector<VariableId> boundary;
    int parent = -1;
  };

  std::vector<Part> partsWith(std::span<const VariableId> variables) const;
  void retirePart(const Part& part, std::span<const VariableId> gone);
  void includeEarlierPriors(std::span<const VariableId> neighbors, std::vector<FactorId>& factors);
  std::vector<FactorId> factorsOf(std::span<const VariableId> variables) const;
  void forget(std::span<const VariableId> variables);

  FactorGraph& graph_;
  EliminationTree& tree_;
  Eliminator& eliminator_;
};

}  // namespace motorcade
