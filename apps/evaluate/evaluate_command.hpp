#pragma once

#include <functional>

#include "apps/evaluate/evaluation.hpp"

namespace CLI {
class App;
}

namespace motorcade {

/// Evaluates, prints the table and writes what else was asked for; gives the exit code. Failures are UserErrors.
int runEvaluate(const EvaluateOptions& options);

/// Registers `motorcade evaluate`; parsing it sets `action`.
void addEvaluateCommand(CLI::App& app, std::function<int()>& action);

}  // namespace motorcade
