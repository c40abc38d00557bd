#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "backend/elimination/elimination_tree.hpp"
#include "backend/solver/clique_work.hpp"
#include "backend/solver/elimination_budget.hpp"

namespace motorcade {

/// Solves for x from the roots of the tree downwards, as far as anything changed: in cliques with work, and below
/// variables that moved. A call that has to stop leaves the rest to the next one, which begins with what has waited
/// longest. Until then x there is some updates old, while R and its right-hand side are those of now.
class BackSubstitution {
 public:
  struct Result {
    std::span<const VariableId> moved;  // lasts until the next call
    std::span<const int> solved;        // cliques; likewise
    std::int64_t scalars = 0;           // substituted
    double largest_change = 0;          // of any x, m or rad
  };

  BackSubstitution(FactorGraph& graph, const EliminationTree& tree, CliqueWork& work, EliminationBudget& budget)
      : graph_(graph), tree_(tree), work_(work), budget_(budget) {}

  /// Steps below which cliques are solved: all, or far ones alone, and the rest waits for a call that spreads all.
  enum class Spread : char { kAll, kFar };
  /// Solves the cliques with work, and up to about `most_scalars` below them, as long as there is time. A variable has
  /// moved when a component of its step since it moved last exceeds `threshold_sigmas` conditional standard deviations,
  /// and far beyond four times that. Smaller steps do not spread.
  Result operator()(double threshold_sigmas, std::int64_t most_scalars, Spread spread = Spread::kAll);
  /// True when all variables of the factor have followed the steps of those above them. Otherwise some of them are
  /// where they were some updates ago.
  bool hasFollowed(FactorId factor) const;
  /// Scalars of the cliques that wait for a later call.
  std::int64_t waitingScalars() const;

 private:
  using Solution = std::int64_t;  // number of a solved clique, counted over all calls

  void solveWork(double threshold_sigmas);
  bool hasTime() const;
  /// Solves a clique whose separator may have moved by that solution or a later one.
  void solve(const Clique& clique, Solution since, double threshold_sigmas);
  void moveVariables(const Clique& clique, double threshold_sigmas);
  void putOff(const Clique& clique, Solution since);
  /// Solves the clique of a variable that waits, if it still does.
  void solveWaiting(VariableId v, double threshold_sigmas);
  void fetchWaiting() const;

  FactorGraph& graph_;
  const EliminationTree& tree_;
  CliqueWork& work_;
  EliminationBudget& budget_;
  Result result_;
  Solution newest_ = 0, first_of_call_ = 1;
  std::vector<VariableId> moved_;
  std::vector<int> solved_;
  std::vector<int> open_;  // cliques with work to solve
  /// Frontal variables of waiting cliques, those that wait longest first; their cliques may be gone by the time.
  std::vector<VariableId> waiting_;
  std::size_t first_waiting_ = 0;     // those before it are done
  Spread spread_ = Spread::kAll;      // of the call at hand
  std::vector<VariableId> hurrying_;  // in a call for far steps: of cliques below a variable that moved far
  /// Solutions per variable: its last, those that moved it last, at all and far, and the one since which it waits; 0:
  /// none.
  std::vector<Solution> solved_by_, moved_by_, moved_far_by_, waiting_since_;
  std::vector<double> x_separator_, x_frontal_;
};

}  // namespace motorcade
