#pragma once

#include "apps/evaluate/measures/evaluation.hpp"

namespace motorcade {

/// Evaluates a run, prints the table and writes the other requested files; returns the exit code. Failures are
/// UserErrors.
int runEvaluate(const EvaluateOptions& options);

}  // namespace motorcade
