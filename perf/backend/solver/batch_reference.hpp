#pragma once

#include <cstddef>

#include "apps/solve/pose_graph_feed.hpp"

namespace motorcade::perf {

/// Batch solution of the first updates of a graph, for more and more of them. Each starts from the one before,
/// relinearizes everything, and goes on until nothing moves. Always solved with the solver's default parameters.
class BatchReference {
 public:
  /// Keeps a reference to the graph.
  explicit BatchReference(const PoseGraph& graph) : feed_(graph, IncrementalSolver::Params{}) {}

  /// Solves up to `updates`, which may not go down. False when it does not converge.
  bool advanceTo(std::size_t updates);
  const PoseGraphFeed& feed() const { return feed_; }

 private:
  PoseGraphFeed feed_;
  std::size_t updates_ = 0;
};

/// Iterates Gauss-Newton until nothing moves any more; false when that does not come about.
bool converge(IncrementalSolver& solver);

/// Excess of a solution's chi2 over the optimum.
double excessPercent(double chi2, double optimum);

}  // namespace motorcade::perf
