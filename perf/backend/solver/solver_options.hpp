#pragma once

#include <nlohmann/json_fwd.hpp>

#include "backend/solver/incremental_solver.hpp"

namespace CLI {
class App;
}

namespace motorcade::perf {

/// Options for the solver's parameters, with the solver's own defaults, so that variants can be compared. All that the
/// benchmark knows of their names is here.
void addSolverOptions(CLI::App& app, IncrementalSolver::Params& params);
nlohmann::ordered_json jsonOf(const IncrementalSolver::Params& params);

}  // namespace motorcade::perf
