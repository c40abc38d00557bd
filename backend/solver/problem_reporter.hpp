#pragma once

#include <vector>

#include "backend/elimination/elimination_tree.hpp"
#include "backend/solver/solver_problem.hpp"

namespace motorcade {

/// Finds out what pivots without information mean: which variables can move, together with which others, and along
/// what.
///
/// A problem is told once. It is told again when it grows by a direction, or when it comes back after an elimination
/// without it. While nothing is wrong an update costs nothing; while something is, it may cost a pass over the
/// connected parts concerned.
class SolverExplanations {
 public:
  /// A pivot below that times its diagonal entry has lost all but some four of its digits: rounding is 1e-16 of the
  /// diagonal, and sums of hundreds of terms leave 1e-15. Long open trajectories come down to 1e-9 honestly.
  static constexpr double kWeakPivot = 1e-11;

  /// Appends what is wrong since the last call.
  void append(const FactorGraph& graph, const EliminationTree& tree, std::vector<SolverProblem>& problems);
  /// The id belongs to a new variable.
  void forget(VariableId v);

 private:
  void forgetMended(const FactorGraph& graph, const EliminationTree& tree);
  std::int64_t toldFreedoms(const SolverProblem& problem, const EliminationTree& tree) const;

  struct Told {
    SolverProblem::Kind kind;
    VariableId variable;
    std::int64_t freedoms;
  };
  std::vector<Told> told_;
};

}  // namespace motorcade
