#pragma once

#include "apps/run/run_options.hpp"

namespace motorcade {

/// Runs a sequence through the pipeline and writes the run folder; gives the exit code. Failures are UserErrors.
int runSequence(const RunOptions& options);

}  // namespace motorcade
