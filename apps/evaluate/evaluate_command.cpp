#include "apps/evaluate/evaluate_command.hpp"

#include <iostream>

#include "apps/evaluate/comparison/recovered_finals.hpp"
#include "apps/evaluate/report/kitti_export.hpp"
#include "apps/evaluate/report/report.hpp"
#include "apps/recorded/recorded_run.hpp"
#include "io/files/line_file.hpp"

namespace motorcade {
namespace {

/// Exports results where asked. Returns true if that is all, as there is no truth to measure by.
bool exportAlone(const EvaluateOptions& options) {
  if (options.export_kitti.empty()) return false;
  RunFolder run = readRunFolder(options.run);
  const Sequence sequence = openSequenceOf(run, {options.sequence, options.fps_hz});
  recoverFinals(run);
  exportKitti(options.export_kitti, run, sequence);
  return options.json.empty() && !readCameraTruth(sequence);
}

}  // namespace

int runEvaluate(const EvaluateOptions& options) {
  if (exportAlone(options)) {
    std::cout << "results in " << options.export_kitti.string()
              << "; nothing is measured, as the sequence has no ground truth\n";
    return 0;
  }
  const Evaluation evaluation = evaluateRun(options);
  std::cout << tableOf(evaluation);
  if (!options.json.empty()) writeAtOnce(options.json, jsonOf(evaluation));
  return 0;
}

}  // namespace motorcade
