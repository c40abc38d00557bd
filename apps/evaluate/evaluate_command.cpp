#include "apps/evaluate/evaluate_command.hpp"

#include <iostream>

#include "apps/evaluate/report.hpp"
#include "io/line_file.hpp"

namespace motorcade {

int runEvaluate(const EvaluateOptions& options) {
  const Evaluation evaluation = evaluateRun(options);
  std::cout << tableOf(evaluation);
  if (!options.json.empty()) writeAtOnce(options.json, jsonOf(evaluation));
  return 0;
}

}  // namespace motorcade
