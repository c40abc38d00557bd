#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "backend/elimination/elimination_tree.hpp"
#include "backend/graph/mark_set.hpp"
#include "backend/solver/clique_work.hpp"

namespace motorcade {

/// Solves for x from the roots of the tree downwards, as far as anything changed: in cliques with work, and below
/// variables that moved. Where a call may not go on, the next one does, with what has waited longest: x there is what
/// it was some updates ago, while R and its right-hand side are those of now.
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
  /// standard deviations; smaller steps do not spread. Solves all cliques with work, and up to about `most_scalars`
  /// below them; 0: no limit.
  Result operator()(double threshold_sigmas, std::int64_t most_scalars = 0);
  /// Cliques that wait for a later call.
  std::size_t waiting() const { return waiting_.size(); }

 private:
  void solveWork(double threshold_sigmas);
  void solve(int id, double threshold_sigmas);
  void moveVariables(const Clique& clique, double threshold_sigmas);
  bool isBelowMoved(int clique) const;

  FactorGraph& graph_;
  const EliminationTree& tree_;
  CliqueWork& work_;
  Result result_;
  std::vector<VariableId> moved_;
  MarkSet has_moved_;             // variables
  std::vector<int> open_;         // cliques with work to solve
  std::deque<int> waiting_;       // cliques below variables that moved, those that wait longest first
  std::vector<char> is_waiting_;  // per clique
  std::vector<double> x_separator_, x_frontal_;
};

}  // namespace motorcade
