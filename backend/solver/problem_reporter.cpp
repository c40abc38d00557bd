#include "backend/solver/problem_reporter.hpp"

#include <algorithm>

#include "backend/solver/problem_finder.hpp"

namespace motorcade {

void ProblemReporter::append(const FactorGraph& graph, const EliminationTree& tree, double weakest_pivot,
                             std::vector<SolverProblem>& problems) {
  if (weakest_pivot >= kWeakPivot) {
    if (!reported_.empty()) forgetSolved(graph, tree);
    return;
  }
  std::vector<Reported> present;
  for (SolverProblem& problem : findProblems(graph, tree)) {
    const std::int64_t reported = reportedFreedoms(problem, tree);
    present.push_back({problem.kind, problem.variable, std::max(reported, problem.freedoms)});
    if (reported < problem.freedoms) problems.push_back(std::move(problem));
  }
  reported_ = std::move(present);
}

/// Of the problem as it was reported, 0 if it was not.
std::int64_t ProblemReporter::reportedFreedoms(const SolverProblem& problem, const EliminationTree& tree) const {
  std::int64_t most = 0;
  for (const Reported& reported : reported_) {
    if (reported.kind != problem.kind) continue;
    // Of a part that moves as a whole it may now be another variable that is held.
    const int clique = tree.cliqueOf(reported.variable);
    const bool same_part = concernsPart(problem.kind) && clique >= 0 &&
                           tree.rootOf(clique) == tree.rootOf(tree.cliqueOf(problem.variable));
    if (reported.variable == problem.variable || same_part) most = std::max(most, reported.freedoms);
  }
  return most;
}

/// Nothing weak was eliminated in this update: those problems are gone whose variables were.
void ProblemReporter::forgetSolved(const FactorGraph& graph, const EliminationTree& tree) {
  std::erase_if(reported_, [&](const Reported& reported) {
    const VariableId v = reported.variable;
    return !graph.contains(v) || tree.cliqueOf(v) < 0 || weakScalars(tree, tree.cliqueOf(v), kWeakPivot).empty();
  });
}

void ProblemReporter::forget(VariableId v) {
  std::erase_if(reported_, [&](const Reported& reported) { return reported.variable == v; });
}

}  // namespace motorcade
