#include "perf/backend/solver/graph_run.hpp"

#include <algorithm>
#include <cstdlib>

#include "perf/backend/solver/batch_reference.hpp"
#include "perf/backend/solver/far_covariances.hpp"

namespace motorcade::perf {
namespace {

constexpr std::ptrdiff_t kClosureFrames = 50;
constexpr double kSettledPercent = 0.1;
constexpr std::size_t kMostSettling = 20'000;
constexpr std::uint64_t kSeed = 1;  // of the pairs whose covariance is asked for

void findOptimum(const PoseGraph& graph, PoseGraphFeed& solved, GraphRun& run) {
  converge(solved.solver());
  run.optimum = solved.chi2();
  PoseGraphFeed at_once(graph, IncrementalSolver::Params{}, PoseGraphFeed::Pace::kAtOnce);
  at_once.next();
  if (!converge(at_once.solver())) return;
  const double from_odometry = at_once.chi2();
  run.reached_from_odometry = excessPercent(from_odometry, run.optimum) < 0.001;
  run.optimum = std::min(run.optimum, from_odometry);
}

GraphRun::Settling settle(PoseGraphFeed& feed) {
  GraphRun::Settling settling;
  for (bool settled = false; !settled && settling.cpu_ms.size() < kMostSettling;) {
    const auto update = feed.settle();
    settling.cpu_ms.push_back(update.cpu_ms);
    settled = update.report.settled();
  }
  settling.chi2 = feed.chi2();
  return settling;
}

}  // namespace

GraphRun runGraph(const PoseGraph& graph, const IncrementalSolver::Params& params) {
  GraphRun run;
  PoseGraphFeed feed(graph, params);
  while (!feed.atEnd()) {
    const auto update = feed.next();
    run.cpu_ms.push_back(update.cpu_ms);
    run.eliminated_scalars.push_back(static_cast<double>(update.report.eliminated_scalars));
    run.substituted_scalars.push_back(static_cast<double>(update.report.substituted_scalars));
    run.problems += update.report.problems.size();
  }
  run.poses = feed.poseCount();
  run.edges = feed.edgeCount();
  run.chi2 = feed.chi2();
  run.held_bytes = feed.solver().heldBytes();
  if (params.budget.isLimited()) run.settling = settle(feed);
  run.far_covariances_ms = farCovariances_ms(feed, graph, kSeed);
  findOptimum(graph, feed, run);
  return run;
}

std::optional<std::size_t> firstClosure(const PoseGraph& graph) {
  std::vector<std::int64_t> ends = graph.frame_ends;
  std::ranges::sort(ends);
  const auto frameOf = [&](std::int64_t pose) { return std::ranges::lower_bound(ends, pose) - ends.begin(); };
  std::optional<std::size_t> first;
  for (const auto& edge : graph.edges) {
    const auto from = frameOf(edge.from), to = frameOf(edge.to);
    if (std::abs(from - to) <= kClosureFrames) continue;
    const auto update = static_cast<std::size_t>(std::max(from, to));
    first = std::min(first.value_or(update), update);
  }
  return first;
}

ClosureRun runClosures(const PoseGraph& graph, const IncrementalSolver::Params& params, std::size_t first_update) {
  ClosureRun run;
  run.first_update = first_update;
  PoseGraphFeed feed(graph, params);
  BatchReference batch(graph);
  for (std::size_t update = 0; !feed.atEnd(); ++update) {
    feed.next();
    if (update < first_update) continue;
    batch.advanceTo(update + 1);
    const double excess = excessPercent(feed.chi2(), batch.feed().chi2());
    run.worst_excess_percent = std::max(run.worst_excess_percent, excess);
    if (excess > kSettledPercent) ++run.unsettled_updates;
    if (excess <= kSettledPercent && !run.updates_until_settled) run.updates_until_settled = update - first_update;
  }
  return run;
}

}  // namespace motorcade::perf
