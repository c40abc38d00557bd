#pragma once

#include "apps/evaluate/measures/evaluation.hpp"

namespace motorcade {

/// Evaluates, prints the table and writes what else was asked for; gives the exit code. Failures are UserErrors.
int runEvaluate(const EvaluateOptions& options);

}  // namespace motorcade
