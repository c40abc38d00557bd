#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "io/files/errors.hpp"
#include "io/files/line_file.hpp"
#include "perf/backend/solver/bench_report.hpp"
#include "perf/backend/solver/solver_options.hpp"
#include "perf/backend/solver/street_grid.hpp"

/// Measures the incremental solver on public pose graphs, beside batch solutions, and on simulated drives of any
/// length.
namespace motorcade::perf {
namespace {

constexpr int kExitCheckFailed = 1, kExitUsage = 2;

/// Folder of the data for tests and scripts, which MOTORCADE_DATA names.
std::filesystem::path dataFolder() {
  const char* const named = std::getenv("MOTORCADE_DATA");
  return named && *named ? named : "../shared/data";
}

struct Options {
  std::set<std::string> parts{"graphs", "drives"};
  std::filesystem::path data = dataFolder() / "posegraphs", json;
  std::vector<std::string> graphs{"manhattan", "sphere2500",  "parking-garage",
                                  "torus3D",   "multibody_8", "multibody_8_loops"};
  std::vector<int> objects{0, 5, 20}, grid_poses{10'000, 20'000};
  MultibodyOptions drive;
  bool check = false;
  IncrementalSolver::Params solver = PoseGraphFeed::solverParams();
};

void addOptions(CLI::App& app, Options& options) {
  app.add_option("--parts", options.parts, "What to measure: graphs, drives, grids (default: graphs and drives)")
      ->check(CLI::IsMember({"graphs", "drives", "grids"}))
      ->delimiter(',');
  app.add_option("--data", options.data, "Folder of the pose graphs")->capture_default_str();
  app.add_option("--graphs", options.graphs, "Names of pose graphs in it, without .g2o")
      ->delimiter(',')
      ->capture_default_str();
  app.add_flag("--check", options.check,
               "Compare with batch solutions along the way, which takes minutes; fail on what is off and on drives "
               "whose updates take "
               "longer with age");
  app.add_option("--objects", options.objects, "Objects in view of the drives")
      ->delimiter(',')
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  app.add_option("--frames", options.drive.frames, "Length of the drives")
      ->check(CLI::Range(1, 10'000'000))
      ->capture_default_str();
  app.add_option("--window", options.drive.window_frames, "Frames that are kept; 0: all")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  app.add_option("--seed", options.drive.seed, "Of the drives, and of the updates that --check looks at")
      ->capture_default_str();
  app.add_option("--grid-poses", options.grid_poses, "Poses of the drives through grids of streets")
      ->delimiter(',')
      ->check(CLI::Range(10, 1'000'000))
      ->capture_default_str();
  app.add_option("--json", options.json, "File for all figures as JSON");
  addSolverOptions(app, options.solver);
}

GraphFigures measure(const std::string& name, const PoseGraph& graph, const Options& options) {
  GraphFigures figures{.name = name, .run = runGraph(graph, options.solver), .closures = {}, .check = {}};
  if (const auto first = firstClosure(graph)) figures.closures = runClosures(graph, options.solver, *first);
  if (options.check) figures.check = checkAgainstBatch(graph, options.solver, options.drive.seed);
  return figures;
}

/// Measures all graphs; false when a check fails.
bool measureGraphs(const Options& options, nlohmann::ordered_json& json) {
  bool good = true;
  printGraphHead();
  for (const std::string& name : options.graphs) {
    const auto file = options.data / (name + ".g2o");
    if (!std::filesystem::exists(file)) {
      std::printf("%-20s not measured: there is no %s\n", name.c_str(), file.c_str());
      continue;
    }
    const auto figures = measure(name, readPoseGraph(file), options);
    printGraph(figures);
    json["graphs"].push_back(jsonOf(figures));
    good = good && (!figures.check || figures.check->failures.empty());
  }
  return good;
}

bool measureGrids(const Options& options, nlohmann::ordered_json& json) {
  bool good = true;
  printGraphHead();
  for (const int poses : options.grid_poses) {
    const auto figures = measure("grid" + std::to_string(poses), streetGrid(poses, options.drive.seed), options);
    printGraph(figures);
    json["grids"].push_back(jsonOf(figures));
    good = good && (!figures.check || figures.check->failures.empty());
  }
  return good;
}

bool measureDrives(const Options& options, nlohmann::ordered_json& json) {
  bool good = true;
  for (const int objects : options.objects) {
    MultibodyOptions drive = options.drive;
    drive.objects = objects;
    const auto run = runMultibody(options.solver, drive);
    printMultibody(run);
    json["drives"].push_back(jsonOf(run));
    good = good && (!run.aging || run.aging->timeRatio() <= MultibodyAging::kMaxRatio);
  }
  return good;
}

int measureAll(const Options& options) {
  nlohmann::ordered_json json = {{"solver", jsonOf(options.solver)}};
  bool good = true;
  if (options.parts.contains("graphs")) good = measureGraphs(options, json) && good;
  if (options.parts.contains("grids")) good = measureGrids(options, json) && good;
  if (options.parts.contains("drives")) good = measureDrives(options, json) && good;
  if (!options.json.empty()) writeAtOnce(options.json, json.dump(2));
  if (good || !options.check) return 0;
  std::printf("\nFAILED: see above\n");
  return kExitCheckFailed;
}

int measure(int argc, char** argv) {
  CLI::App app("Measures the incremental solver on public pose graphs and on simulated drives.", "solver_bench");
  Options options;
  addOptions(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kExitUsage;
  }
  return measureAll(options);
}

}  // namespace
}  // namespace motorcade::perf

int main(int argc, char** argv) try {
  return motorcade::perf::measure(argc, argv);
} catch (const motorcade::UserError& error) {
  std::fprintf(stderr, "solver_bench: %s\n", error.what());
  return error.exitCode();
} catch (const std::exception& error) {
  constexpr int kExitInternal = 70;
  std::fprintf(stderr, "solver_bench: %s\n", error.what());
  return kExitInternal;
}
