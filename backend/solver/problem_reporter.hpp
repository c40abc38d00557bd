#pragma once

#include <vector>

#include "backend/elimination/elimination_tree.hpp"
#include "backend/solver/solver_problem.hpp"

namespace motorcade {

/// Reports each problem of the graph once. It is reported again when it grows by a direction, or when it comes back
/// after an elimination without it.
///
/// While nothing is wrong an update costs nothing; while something is, it may cost a pass over the connected parts
/// concerned.
class ProblemReporter {
 public:
  /// Appends the problems since the last call, since when `weakest_pivot` was the weakest (see Eliminator).
  void append(const FactorGraph& graph, const EliminationTree& tree, double weakest_pivot,
              std::vector<SolverProblem>& problems);
  /// Forgets a variable whose id belongs to a new one.
  void forget(VariableId v);

 private:
  struct Reported {
    SolverProblem::Kind kind;
    VariableId variable;
    std::int64_t freedoms;
  };

  void forgetSolved(const FactorGraph& graph, const EliminationTree& tree);
  std::int64_t reportedFreedoms(const SolverProblem& problem, const EliminationTree& tree) const;

  std::vector<Reported> reported_;
};

}  // namespace motorcade
