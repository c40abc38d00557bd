#include "apps/solve/solution.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/thread_placement.hpp"
#include "io/files/number_ranges.hpp"

namespace motorcade {
namespace {

constexpr int kMaxIterations = 40;
constexpr std::size_t kMostSettling = 20'000;  // updates; each brings an edge that waits nearer
constexpr double kConverged = 1e-6;            // m and rad: further steps would change chi2 by its last digits

/// "pose 7", "poses 7-9, 12"
std::string namesOf(const std::vector<std::int64_t>& ids) {
  return (ids.size() == 1 ? "pose " : "poses ") + rangesOf(ids);
}

/// Adds the factors that the solver had to leave out, each once. A later edge may mend a fault of the system.
void addRefusals(const IncrementalSolver::Report& report, const PoseGraphFeed& feed,
                 std::vector<SolveProblem>& problems) {
  using Kind = SolverProblem::Kind;
  const auto nameOf = [&](VariableId v) { return namesOf({feed.poseOf(v)}); };
  for (const SolverProblem& found : report.problems) {
    if (found.kind != Kind::kUnknownVariable && found.kind != Kind::kRepeatedVariable) continue;
    problems.push_back({std::string(motorcade::nameOf(found.kind)),
                        nameOf(found.variable),
                        describe(found, feed.solver().graph(), nameOf),
                        {feed.poseOf(found.variable)}});
  }
}

/// Adds the directions along which the edges do not determine the poses. Badly conditioned ones are solved, if badly.
void addUndetermined(const PoseGraphFeed& feed, Solution& solution) {
  const auto nameOf = [&](VariableId v) { return namesOf({feed.poseOf(v)}); };
  for (const SolverProblem& found : feed.problemsNow()) {
    solution.problems.push_back({std::string(motorcade::nameOf(found.kind)),
                                 nameOf(found.variable),
                                 describe(found, feed.solver().graph(), nameOf),
                                 {feed.poseOf(found.variable)}});
    if (found.kind != SolverProblem::Kind::kBadlyConditioned) solution.unsolved.push_back(solution.problems.back());
  }
}

void addEdgeProblems(const PoseGraph& graph, const PoseGraphFeed& feed, std::vector<SolveProblem>& problems) {
  for (const std::size_t refused : feed.refusedEdges()) {
    const auto& edge = graph.edges[refused];
    problems.push_back({"not_finite",
                        "edge from pose " + std::to_string(edge.from) + " to pose " + std::to_string(edge.to),
                        "line " + std::to_string(edge.line) + ": its numbers overflow; left out",
                        {edge.from, edge.to}});
  }
}

void addGaugeProblems(const PoseGraphFeed& feed, std::vector<SolveProblem>& problems) {
  using Why = PoseGraphGauge::Unapplied::Why;
  for (const auto& [id, why] : feed.gauge().unapplied())
    problems.push_back({"fix_not_applied",
                        namesOf({id}),
                        why == Why::kNoSuchPose ? "FIX is not applied: no other line names the pose"
                                                : "FIX is not applied: no VERTEX line says where the pose is",
                        {id}});
}

void addPartProblems(const PoseGraphFeed& feed, std::vector<SolveProblem>& problems) {
  const PoseGraphGauge& gauge = feed.gauge();
  const auto idsOf = [&](const std::vector<std::size_t>& poses) {
    std::vector<std::int64_t> ids;
    for (const std::size_t pose : poses) ids.push_back(feed.index().id(pose));
    return ids;
  };
  const std::string main = namesOf(idsOf(gauge.parts()[gauge.mainPart()].held));
  for (const auto& part : feed.disconnectedParts()) {
    const auto& of_first = gauge.parts()[gauge.partOf(feed.index().at(part.front()))];
    const std::string what = of_first.size == 1 ? "; left where it is"
                                                : "; solved by itself, with " + namesOf(idsOf(of_first.held)) + " held";
    std::string sentence = "disconnected part: no edge joins it to the rest, which is held by ";
    sentence += main;
    sentence += what;
    problems.push_back({"disconnected_part", namesOf(part), std::move(sentence), part});
  }
}

void addPoseProblems(const PoseGraphFeed& feed, std::vector<SolveProblem>& problems) {
  addGaugeProblems(feed, problems);
  for (const auto& late : feed.lateJoins()) {
    problems.push_back(
        {"joined_late", namesOf(late.waited),
         "no edge to an earlier pose: waited until pose " + std::to_string(late.joining) + " joined them to the rest",
         late.waited});
  }
  addPartProblems(feed, problems);
}

Solution solutionOf(const PoseGraph& graph, const PoseGraphFeed& feed, Solution&& solution) {
  solution.poses = feed.poseCount();
  solution.edges = feed.edgeCount();
  solution.chi2 = feed.chi2();
  solution.vertices = feed.vertices();
  addEdgeProblems(graph, feed, solution.problems);
  addPoseProblems(feed, solution.problems);
  addUndetermined(feed, solution);
  const auto fail = [&](const SolveProblem& problem) {
    solution.problems.push_back(problem);
    solution.unsolved.push_back(problem);
  };
  if (!std::isfinite(solution.chi2))
    fail({"not_finite", "solution", "the estimates overflow: a measurement or its information is too large", {}});
  if (solution.edges == 0 && solution.complete)
    fail({"no_edges", "graph", "no edge counts, nothing tells where one pose is from another", {}});
  return std::move(solution);
}

Solution withFileProblems(const PoseGraph& graph) {
  Solution solution;
  for (const auto& problem : graph.problems)
    solution.problems.push_back({std::string(nameOf(problem.kind)), problem.name, problem.detail, problem.poses});
  return solution;
}

void feedAll(PoseGraphFeed& feed, const SolveProgress& progress, Solution& solution) {
  while (solution.complete && !feed.atEnd()) {
    const auto update = feed.next();
    solution.update_ms.push_back(update.cpu_ms);
    solution.update_eliminated_scalars.push_back(update.report.eliminated_scalars);
    solution.total_ms += update.cpu_ms;
    solution.waiting_edges = update.report.waiting_factors;
    solution.waiting_chi2 = update.report.waiting_chi2;
    solution.waiting_scalars = update.report.waiting_scalars;
    addRefusals(update.report, feed, solution.problems);
    solution.complete = progress(solution.update_ms.size(), feed.updateCount());
  }
}

/// Lets the work come through that the budget put off, in updates of their own.
void settle(PoseGraphFeed& feed, const SolveProgress& progress, Solution& solution) {
  for (bool settled = false; solution.complete && !settled && solution.settling_ms.size() < kMostSettling;) {
    const auto update = feed.settle();
    solution.settling_ms.push_back(update.cpu_ms);
    solution.total_ms += update.cpu_ms;
    settled = update.report.settled();
    solution.complete = progress(feed.updateCount(), feed.updateCount());
  }
}

/// True when nothing moves any more, or when it was stopped.
bool converge(PoseGraphFeed& feed, const SolveProgress& progress, Solution& solution) {
  for (int iteration = 1; solution.complete && iteration <= kMaxIterations; ++iteration) {
    const double start_ms = threadCpu_ms();
    const auto& report = feed.solver().converge(1, kConverged);
    solution.total_ms += threadCpu_ms() - start_ms;
    addRefusals(report, feed, solution.problems);
    if (report.largest_change < kConverged) return std::isfinite(feed.chi2());
    solution.complete = progress(iteration, kMaxIterations);
  }
  return !solution.complete;
}

}  // namespace

Solution solveIncrementally(const PoseGraph& graph, const IncrementalSolver::Params& params,
                            const SolveProgress& progress) {
  Solution solution = withFileProblems(graph);
  PoseGraphFeed feed(graph, params);
  feedAll(feed, progress, solution);
  if (params.budget.isLimited()) settle(feed, progress, solution);
  return solutionOf(graph, feed, std::move(solution));
}

Solution solveAtOnce(const PoseGraph& graph, const IncrementalSolver::Params& params, const SolveProgress& progress) {
  Solution solution = withFileProblems(graph);
  PoseGraphFeed feed(graph, params, PoseGraphFeed::Pace::kAtOnce);
  feedAll(feed, progress, solution);
  if (converge(feed, progress, solution)) return solutionOf(graph, feed, std::move(solution));

  Solution second = withFileProblems(graph);
  second.total_ms = solution.total_ms;
  PoseGraphFeed driven(graph, params);
  feedAll(driven, progress, second);
  if (!converge(driven, progress, second)) {
    second.unsolved.push_back({"not_converged",
                               "solution",
                               "Gauss-Newton moved on after " + std::to_string(kMaxIterations) + " iterations",
                               {}});
    second.problems.push_back(second.unsolved.back());
  }
  return solutionOf(graph, driven, std::move(second));
}

}  // namespace motorcade
