#pragma once

#include <vector>

#include "backend/elimination/elimination_tree.hpp"
#include "backend/solver/null_space.hpp"
#include "backend/solver/solver_problem.hpp"

namespace motorcade {

/// Ratio of a pivot to its diagonal entry below which all but some four of its digits are lost. Rounding is 1e-16 of
/// the diagonal, and sums of hundreds of terms leave 1e-15. Long open trajectories come down to 1e-9 with every digit
/// sound.
constexpr double kWeakPivot = 1e-11;

/// True for a kind of problem that lies in a connected part of the graph as a whole.
bool concernsPart(SolverProblem::Kind kind);

/// Finds all that is wrong with the system from its weak pivots: which variables can move, together with which others,
/// and along what.
std::vector<SolverProblem> findProblems(const FactorGraph& graph, const EliminationTree& tree);

}  // namespace motorcade
