#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "apps/solve/solution.hpp"

namespace motorcade {

struct SolveOptions {
  std::filesystem::path graph{}, out{}, json{};
  std::string policy = "fluid";
  int batch_every_updates = 0;      // 0: the solver's own
  std::int64_t budget_scalars = 0;  // 0: no limit
  double budget_ms = 0;             // 0: no limit
  bool at_once = false, every_update = false;
};

/// Solves a pose graph, prints the result and writes the requested files; returns the exit code. Failures are
/// UserErrors.
int runSolve(const SolveOptions& options);

}  // namespace motorcade
