#include "apps/evaluate/evaluate_command.hpp"

#include <iostream>
#include <memory>

#include <CLI/CLI.hpp>

#include "apps/evaluate/report.hpp"
#include "io/line_file.hpp"

namespace motorcade {

int runEvaluate(const EvaluateOptions& options) {
  const Evaluation evaluation = evaluateRun(options);
  std::cout << tableOf(evaluation);
  if (!options.json.empty()) writeAtOnce(options.json, jsonOf(evaluation));
  return 0;
}

void addEvaluateCommand(CLI::App& app, std::function<int()>& action) {
  const auto options = std::make_shared<EvaluateOptions>();
  CLI::App* command = app.add_subcommand("evaluate", "Measure a run against the ground truth of its sequence");
  command->add_option("run", options->run, "Run folder")->required();
  command->add_option("--sequence", options->sequence, "The sequence that was run")->required();
  command->add_option("--fps", options->fps_hz, "Capture rate where the sequence has no times [Hz]")
      ->capture_default_str();
  command->add_option("--baseline", options->baseline,
                      "KITTI pose lines of another camera trajectory, for the relative error");
  command->add_option("--baseline-run", options->baseline_run,
                      "Run folder of another method, for the relative error of the objects");
  command->add_option("--export-truth", options->export_truth,
                      "Folder for the true trajectories of camera and objects");
  command->add_option("--json", options->json, "File for all measures as JSON");
  command->add_flag("--uninterpolated", options->uninterpolated,
                    "Take oxts packet k for image k, as published evaluations do");
  command->callback([options, &action] { action = [options] { return runEvaluate(*options); }; });
}

}  // namespace motorcade
