#pragma once

#include <vector>

#include "apps/solve/pose_graph_feed.hpp"

namespace motorcade::perf {

/// CPU time of joint covariances of two poses that lie at least a third of the drive apart, the first and the newest
/// among them, after the drive. [ms]
std::vector<double> farCovariances_ms(const PoseGraphFeed& feed, const PoseGraph& graph, std::uint64_t seed);

}  // namespace motorcade::perf
