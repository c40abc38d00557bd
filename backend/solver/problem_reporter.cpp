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

/// Freedoms of the problem when it was reported, 0 if it was not.
std::int64_t ProblemReporter::reportedFreedoms(const SolverProblem& problem, const EliminationTree& tree) const {
  std::int64_t most = 0;
  for (const Reported& reported : reported_) {
    if (reported.kind != problem.kind) continue;
    // A part that moves as a whole may be held at another variable now.
    const int clique = tree.cliqueOf(reported.variable);
    const bool same_part = concernsPart(problem.kind) && clique >= 0 &&
                           tree.rootOf(clique) == tree.rootOf(tree.cliqueOf(problem.variable));
    if (reported.variable == problem.variable || same_part) most = std::max(most, reported.freedoms);
  }
  return most;
}

/// Forgets problems whose variable left or has no weak scalar in its clique any more; nothing weak was eliminated here.
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
