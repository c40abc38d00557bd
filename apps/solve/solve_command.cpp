#include "apps/solve/solve_command.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/console/progress.hpp"
#include "apps/console/stop_signals.hpp"
#include "io/files/errors.hpp"
#include "io/files/json_text.hpp"
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
  params.budget = {.scalars = options.budget_scalars, .ms = options.budget_ms};
  return params;
}

struct Times {
  double median_ms = 0, p99_ms = 0, max_ms = 0;
};

/// Percentiles by nearest rank: each is the time of an update.
Times timesOf(std::vector<double> update_ms) {
  if (update_ms.empty()) return {};
  std::ranges::sort(update_ms);
  const auto rank = [&](double share) {
    return update_ms[static_cast<std::size_t>(std::ceil(share * static_cast<double>(update_ms.size()))) - 1];
  };
  return {rank(0.5), rank(0.99), update_ms.back()};
}

/// Report for people: times, chi2, counts, and a line for each problem.
std::string textOf(const Solution& solution) {
  const Times times = timesOf(solution.update_ms);
  std::string text = fmt::format(
      "{} poses, {} edges, {} updates\n"
      "chi2 {:.6f}\n"
      "CPU time: total {:.3f} s; per update median {:.3f} ms, p99 {:.3f} ms, max {:.3f} ms\n",
      solution.poses, solution.edges, solution.update_ms.size(), solution.chi2, 1e-3 * solution.total_ms,
      times.median_ms, times.p99_ms, times.max_ms);
  if (solution.waiting_edges > 0 || solution.waiting_scalars > 0)
    text += fmt::format("put off by the budget: {} edges, whose chi2 is {:.6g}, and {} scalars to substitute\n",
                        solution.waiting_edges, solution.waiting_chi2, solution.waiting_scalars);
  if (!solution.settling_ms.empty())
    text += fmt::format("settled in {} further updates: max {:.3f} ms\n", solution.settling_ms.size(),
                        std::ranges::max(solution.settling_ms));
  if (!solution.problems.empty()) text += std::to_string(solution.problems.size()) + " problems\n";
  for (const auto& problem : solution.problems) text += "  " + problem.name + ": " + problem.detail + "\n";
  return text;
}

/// The same for programs.
std::string jsonOf(const Solution& solution, const SolveOptions& options) {
  const Times times = timesOf(solution.update_ms);
  nlohmann::ordered_json json = {{"graph", options.graph.string()},
                                 {"poses", solution.poses},
                                 {"edges", solution.edges},
                                 {"complete", solution.complete},
                                 {"solved", solution.complete && solution.unsolved.empty()},
                                 {"updates", solution.update_ms.size()},
                                 {"chi2", solution.chi2},
                                 {"total_s", 1e-3 * solution.total_ms},
                                 {"median_ms", times.median_ms},
                                 {"p99_ms", times.p99_ms},
                                 {"max_ms", times.max_ms},
                                 {"waiting_edges", solution.waiting_edges},
                                 {"waiting_chi2", solution.waiting_chi2},
                                 {"waiting_scalars", solution.waiting_scalars}};
  if (!solution.settling_ms.empty()) {
    json["settling_updates"] = solution.settling_ms.size();
    json["settling_max_ms"] = std::ranges::max(solution.settling_ms);
  }
  json["problems"] = nlohmann::ordered_json::array();
  for (const auto& p : solution.problems)
    json["problems"].push_back({{"kind", p.kind}, {"name", p.name}, {"detail", p.detail}, {"poses", p.poses}});
  if (options.every_update) {
    json["update_ms"] = solution.update_ms;
    json["update_eliminated_scalars"] = solution.update_eliminated_scalars;
  }
  return jsonText(json, 2);
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
