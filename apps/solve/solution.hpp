#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/solve/pose_graph_feed.hpp"

namespace motorcade {

/// A problem of a graph or its solution that the user should know.
struct SolveProblem {
  std::string kind;    // one word
  std::string name;    // its subject: "pose 17"
  std::string detail;  // what, and what became of it
  std::vector<std::int64_t> poses;
};

/// A solved graph, with the cost of solving it.
struct Solution {
  std::size_t poses = 0, edges = 0;  // in the solution
  bool complete = true;              // not stopped before its end
  double chi2 = 0, total_ms = 0;
  std::vector<double> update_ms;  // CPU time of each update
  std::vector<std::int64_t> update_eliminated_scalars;
  /// State after the graph's last update: edges that the budget put off, their chi2, and scalars to substitute.
  int waiting_edges = 0;
  double waiting_chi2 = 0;
  std::int64_t waiting_scalars = 0;
  /// CPU time of each update after that, until nothing waits; with a budget alone. The solution is that of the last
  /// one.
  std::vector<double> settling_ms;
  std::vector<SolveProblem> problems;  // of the file, then of the solution
  std::vector<SolveProblem> unsolved;  // those for which it is no solution
  std::vector<PoseGraph::Vertex> vertices;
};

/// Called after each step with the numbers of steps done and of possible ones. Returns false to stop the work there.
using SolveProgress = std::function<bool(std::size_t done, std::size_t count)>;

/// Smooths the graph as it comes, an update per pose or frame.
Solution solveIncrementally(const PoseGraph& graph, const IncrementalSolver::Params& params,
                            const SolveProgress& progress);

/// Gauss-Newton on the whole graph until nothing moves, starting from odometry. If that does not converge, it starts
/// from the incremental solution.
Solution solveAtOnce(const PoseGraph& graph, const IncrementalSolver::Params& params, const SolveProgress& progress);

}  // namespace motorcade
