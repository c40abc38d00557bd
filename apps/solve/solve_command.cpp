#include "apps/solve/solve_command.hpp"

#include <iostream>
#include <optional>

#include "apps/console/progress.hpp"
#include "apps/console/stop_signals.hpp"
#include "apps/solve/solution.hpp"
#include "apps/solve/solve_report.hpp"
#include "io/files/errors.hpp"
#include "io/files/line_file.hpp"

namespace motorcade {
namespace {

IncrementalSolver::Params solverParams(const SolveOptions& options) {
  IncrementalSolver::Params params = PoseGraphFeed::solverParams();
  params.policy = options.policy == "every" ? IncrementalSolver::Policy::kEveryN : IncrementalSolver::Policy::kFluid;
  if (options.batch_every_updates > 0) {
    if (options.policy != "every") throw UsageError("--every goes with --policy every");
    params.batch_every_updates = options.batch_every_updates;
  }
  params.budget.scalars = options.budget_scalars;
  return params;
}

}  // namespace

int runSolve(const SolveOptions& options) {
  const auto params = solverParams(options);
  PoseGraph graph = readPoseGraph(options.graph);
  StopSignals signals;
  const auto watch = signals.watch([] {});  // the progress asks for it
  std::optional<Progress> shown;
  const SolveProgress progress = [&](std::size_t done, std::size_t count) {
    if (!shown || done == 1) shown.emplace("step", count);
    shown->show(done);
    return signals.received() == 0;
  };
  Solution solution =
      options.at_once ? solveAtOnce(graph, params, progress) : solveIncrementally(graph, params, progress);
  shown.reset();
  std::cout << textOf(solution);
  if (!options.json.empty()) writeAtOnce(options.json, jsonOf(solution, options));
  if (!options.out.empty()) {
    graph.vertices = std::move(solution.vertices);
    writePoseGraph(options.out, graph);
  }
  if (!solution.complete) return kExitSignal + signals.received();
  if (!solution.unsolved.empty())
    throw InputError(options.graph.string() + ": could not be solved: " + solution.unsolved.front().detail);
  return 0;
}

}  // namespace motorcade
