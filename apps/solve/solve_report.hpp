#pragma once

#include <string>

#include "apps/solve/solution.hpp"
#include "apps/solve/solve_command.hpp"

namespace motorcade {

/// Report for people: times, chi2, counts, and a line for each problem.
std::string textOf(const Solution& solution);

/// The same for programs.
std::string jsonOf(const Solution& solution, const SolveOptions& options);

}  // namespace motorcade
