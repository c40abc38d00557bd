#include "apps/solve/solve_command.hpp"

#include <iostream>
#include <memory>

#include <CLI/CLI.hpp>

#include "apps/solve/solution.hpp"
#include "apps/solve/solve_report.hpp"
#include "io/errors.hpp"
#include "io/line_file.hpp"

namespace motorcade {
namespace {

IncrementalSolver::Params solverParams(const SolveOptions& options) {
  IncrementalSolver::Params params;
  params.policy = options.policy == "every" ? IncrementalSolver::Policy::kEveryN : IncrementalSolver::Policy::kFluid;
  if (options.batch_every_updates > 0) {
    if (options.policy != "every") throw UsageError("--every goes with --policy every");
    params.batch_every_updates = options.batch_every_updates;
  }
  params.budget_scalars = options.budget_scalars;
  return params;
}

}  // namespace

int runSolve(const SolveOptions& options) {
  const auto params = solverParams(options);
  PoseGraph graph = readPoseGraph(options.graph);
  Solution solution = options.at_once ? solveAtOnce(graph, params) : solveIncrementally(graph, params);
  std::cout << textOf(solution);
  if (!options.json.empty()) writeAtOnce(options.json, jsonOf(solution, options));
  if (!options.out.empty()) {
    graph.vertices = std::move(solution.vertices);
    writePoseGraph(options.out, graph);
  }
  return 0;
}

void addSolveCommand(CLI::App& app, std::function<int()>& action) {
  const auto options = std::make_shared<SolveOptions>();
  CLI::App* command =
      app.add_subcommand("solve", "Smooth a pose graph in g2o form incrementally, one update per new pose");
  command->add_option("graph", options->graph, "g2o file, of poses in the plane or in space")->required();
  command->add_option("--out", options->out, "g2o file for the optimized graph");
  command->add_option("--json", options->json, "File for times, chi2 and problems as JSON");
  command
      ->add_option("--policy", options->policy, "fluid: relinearize what is off; every: a batch step every N updates")
      ->check(CLI::IsMember({"fluid", "every"}))
      ->capture_default_str();
  command->add_option("--every", options->batch_every_updates, "N of --policy every")->check(CLI::PositiveNumber);
  command
      ->add_option("--budget", options->budget_scalars, "Scalars eliminated per update beyond what new edges ask for")
      ->check(CLI::PositiveNumber);
  command->add_flag("--batch", options->at_once, "The batch solution: everything at once, until it converges");
  command->add_flag("--updates", options->every_update, "Write the times of every update to the JSON file too");
  command->callback([options, &action] { action = [options] { return runSolve(*options); }; });
}

}  // namespace motorcade
