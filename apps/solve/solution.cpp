#include "apps/solve/solution.hpp"

#include <algorithm>
#include <cmath>

#include "core/thread_clock.hpp"

namespace motorcade {
namespace {

constexpr int kMaxIterations = 40;
constexpr double kConverged = 1e-6;  // m and rad: further steps would change chi2 by its last digits

/// "pose 7", "poses 7-9, 12"
std::string namesOf(const std::vector<std::int64_t>& ids) {
  std::string text = ids.size() == 1 ? "pose" : "poses";
  for (std::size_t i = 0; i < ids.size();) {
    std::size_t last = i;
    while (last + 1 < ids.size() && ids[last + 1] == ids[last] + 1) ++last;
    text.append(i == 0 ? " " : ", ").append(std::to_string(ids[i]));
    if (last > i) text.append("-").append(std::to_string(ids[last]));
    i = last + 1;
  }
  return text;
}

/// What the solver itself found, each once.
void addSolverProblems(const IncrementalSolver::Report& report, const PoseGraphFeed& feed,
                       std::vector<SolveProblem>& problems) {
  const auto nameOf = [&](VariableId v) { return namesOf({feed.poseOf(v)}); };
  for (const SolverProblem& found : report.problems) {
    if (found.kind == SolverProblem::Kind::kNotFinite) continue;  // reported with the edge and its line
    SolveProblem problem{std::string(motorcade::nameOf(found.kind)),
                         nameOf(found.variable),
                         describe(found, feed.solver().graph(), nameOf),
                         {feed.poseOf(found.variable)}};
    const auto same = [&](const SolveProblem& p) { return p.kind == problem.kind && p.name == problem.name; };
    if (std::ranges::none_of(problems, same)) problems.push_back(std::move(problem));
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

void addPoseProblems(const PoseGraph& graph, const PoseGraphFeed& feed, std::vector<SolveProblem>& problems) {
  const std::string gauge = namesOf({feed.gaugePose()});
  for (const std::int64_t id : graph.fixed)
    if (id != feed.gaugePose())
      problems.push_back({"fix_not_applied", namesOf({id}), "FIX is not applied: " + gauge + " is held", {id}});
  for (const auto& late : feed.lateJoins()) {
    problems.push_back(
        {"joined_late", namesOf(late.waited),
         "no edge to an earlier pose: waited until pose " + std::to_string(late.joining) + " joined them to the rest",
         late.waited});
  }
  for (const auto& part : feed.disconnectedParts()) {
    problems.push_back({"disconnected_part", namesOf(part),
                        "disconnected part: no edge joins it to " + gauge + "; not optimized, and not counted in chi2",
                        part});
  }
}

Solution solutionOf(const PoseGraph& graph, const PoseGraphFeed& feed, Solution&& solution) {
  solution.poses = feed.poseCount();
  solution.edges = feed.edgeCount();
  solution.chi2 = feed.chi2();
  solution.vertices = feed.vertices();
  addEdgeProblems(graph, feed, solution.problems);
  addPoseProblems(graph, feed, solution.problems);
  if (!std::isfinite(solution.chi2))
    solution.problems.push_back(
        {"not_finite", "solution", "the estimates overflow: a measurement or its information is too large", {}});
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
    addSolverProblems(update.report, feed, solution.problems);
    solution.complete = progress(solution.update_ms.size(), feed.updateCount());
  }
}

/// True when nothing moves any more, or when it was stopped.
bool converge(PoseGraphFeed& feed, const SolveProgress& progress, Solution& solution) {
  for (int iteration = 1; solution.complete && iteration <= kMaxIterations; ++iteration) {
    const double start_ms = threadCpu_ms();
    const auto& report = feed.solver().converge(1, kConverged);
    solution.total_ms += threadCpu_ms() - start_ms;
    addSolverProblems(report, feed, solution.problems);
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
    second.problems.push_back({"not_converged",
                               "solution",
                               "Gauss-Newton moved on after " + std::to_string(kMaxIterations) + " iterations",
                               {}});
  }
  return solutionOf(graph, driven, std::move(second));
}

}  // namespace motorcade
