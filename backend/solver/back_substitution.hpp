#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "backend/elimination/elimination_tree.hpp"
#include "backend/graph/mark_set.hpp"
#include "backend/solver/clique_work.hpp"

namespace motorcade {

/// Solves for x from the roots of the tree downwards, as far as anything changed: in cliques with work, and below
/// variables that moved.
class BackSubstitution {
 public:
  struct Result {
    std::span<const VariableId> moved;  // lasts until the next call
    std::int64_t scalars = 0;           // substituted
    double largest_change = 0;          // of any x, m or rad
  };

  BackSubstitution(FactorGraph& graph, const EliminationTree& tree, CliqueWork& work)
      : graph_(graph), tree_(tree), work_(work) {}

  /// A variable has moved when a component of its step since it moved last exceeds `threshold_sigmas` conditional
  /// standard deviations; smaller steps do not spread. Leaves no work behind.
  Result operator()(double threshold_sigmas);

 private:
  void solve(const Clique& clique, double threshold_sigmas);

  FactorGraph& graph_;
  const EliminationTree& tree_;
  CliqueWork& work_;
  Result result_;
  std::vector<VariableId> moved_;
  MarkSet has_moved_;      // variables
  std::vector<int> open_;  // cliques to solve
  std::vector<double> x_separator_, x_frontal_;
};

}  // namespace motorcade
