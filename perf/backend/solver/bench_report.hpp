#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "perf/backend/solver/graph_run.hpp"
#include "perf/backend/solver/multibody_run.hpp"
#include "perf/backend/solver/solution_check.hpp"

/// Rows of tables on standard output, and the same figures as JSON. Scalars, eliminated or substituted, are per update.
namespace motorcade::perf {

struct GraphFigures {
  std::string name;
  GraphRun run;
  std::optional<ClosureRun> closures;
  std::optional<SolutionCheck> check;
};

void printGraphHead();
void printGraph(const GraphFigures& figures);
nlohmann::ordered_json jsonOf(const GraphFigures& figures);

void printMultibody(const MultibodyRun& run);
nlohmann::ordered_json jsonOf(const MultibodyRun& run);

}  // namespace motorcade::perf
