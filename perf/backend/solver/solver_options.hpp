#pragma once

#include <nlohmann/json_fwd.hpp>

#include "backend/solver/incremental_solver.hpp"

namespace CLI {
class App;
}

namespace motorcade::perf {

/// Adds options for the solver's parameters, with the solver's own defaults, so that variants can be compared. The
/// benchmark knows their names only here.
void addSolverOptions(CLI::App& app, IncrementalSolver::Params& params);
nlohmann::ordered_json jsonOf(const IncrementalSolver::Params& params);

}  // namespace motorcade::perf
