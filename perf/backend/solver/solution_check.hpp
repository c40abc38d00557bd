#pragma once

#include <string>
#include <vector>

#include "apps/solve/pose_graph_feed.hpp"

namespace motorcade::perf {

/// An incremental solution beside batch solutions of the same part of the graph.
struct SolutionCheck {
  static constexpr double kMaxExcessPercent = 1;
  static constexpr double kMaxPoseSigmas = 0.1;

  struct Chi2 {
    std::size_t updates;
    double excess_percent;
  };
  /// The newest pose, of those of the last update, that is farthest off: Mahalanobis distance in the marginal
  /// covariance of the batch solution, over the square root of its dimension.
  struct Pose {
    std::size_t updates;
    double sigmas;
  };
  std::vector<Chi2> chi2;  // after each tenth of the updates
  std::vector<Pose> pose;  // after random updates
  std::vector<std::string> failures;
};

SolutionCheck checkAgainstBatch(const PoseGraph& graph, const IncrementalSolver::Params& params, std::uint64_t seed);

}  // namespace motorcade::perf
