#pragma once

#include <optional>
#include <vector>

#include "apps/solve/pose_graph_feed.hpp"
#include "perf/backend/solver/quantiles.hpp"

namespace motorcade::perf {

/// Cost of solving a pose graph, with an update per pose or frame.
struct GraphRun {
  std::size_t poses = 0, edges = 0, problems = 0;                       // in the solution; that updates reported
  std::vector<double> cpu_ms, eliminated_scalars, substituted_scalars;  // per update
  std::vector<double> far_covariances_ms;                               // after the last update
  double chi2 = 0;                                                      // after the last update
  std::size_t held_bytes = 0;

  /// Further updates with a budget, each within its own, until nothing waits, and chi2 then.
  struct Settling {
    std::vector<double> cpu_ms;
    double chi2 = 0;
  };
  std::optional<Settling> settling;

  /// The lowest chi2 that Gauss-Newton reaches from the incremental solution and, all at once, from odometry.
  double optimum = 0;
  bool reached_from_odometry = false;  // also from there
};
GraphRun runGraph(const PoseGraph& graph, const IncrementalSolver::Params& params);

/// Response of the solver to edges to poses of long ago, which bend everything in between.
struct ClosureRun {
  std::size_t first_update = 0;  // with such an edge
  /// Updates after the first until chi2 is within 0.1 % of the optimum of the graph so far.
  std::optional<std::size_t> updates_until_settled;
  std::size_t unsettled_updates = 0;  // from the first on
  double worst_excess_percent = 0;
};
/// The first update with an edge to a pose more than 50 frames back; empty where the graph has none, or has no frames.
std::optional<std::size_t> firstClosure(const PoseGraph& graph);
ClosureRun runClosures(const PoseGraph& graph, const IncrementalSolver::Params& params, std::size_t first_update);

}  // namespace motorcade::perf
