#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "backend/graph/factor_graph.hpp"

namespace motorcade {

/// A fault of a graph, found by an update.
struct SolverProblem {
  enum class Kind {
    kUnconstrained,     // no factor constrains the variable along `directions`: its estimate stays where it is
    kMissingPrior,      // nothing holds a connected part of the graph: all its variables can move together
    kDisconnectedPart,  // the same, while something holds the rest of the graph
    kBadlyConditioned,  // factors constrain the variable by so little, compared with their size, that rounding eats the
                        // result
    kIndefinite,        // factors state negative information along `directions`: the estimate stays where it is
    kNotFinite,         // the factor overflows or is not a number at its variables' estimates: it was left out
    kUnknownVariable,   // the factor names a variable that is not in the graph: it was left out
    kRepeatedVariable,  // the factor names a variable twice: it was left out
  };
  Kind kind = Kind::kUnconstrained;
  VariableId variable;  // of those that move together, the one that was held
  std::vector<SmallVector>
      directions{};  // of unit length, in the variable's own perturbation; empty for a factor that was left out
  std::vector<FactorId> factors{};   // that touch the variable
  std::vector<VariableId> others{};  // that a factor that was left out names besides
  std::int64_t freedoms = 0;  // independent motions; more than `directions` when the variable rests in some of them
  std::int64_t moving_variables = 0;  // that take part in them
  std::int64_t part_variables = 0;    // in the connected part of the graph
};

/// Name of a problem in one word: "missing_prior".
std::string_view nameOf(SolverProblem::Kind kind);

/// Describes in a sentence what is wrong, what the solver did, and how to fix it. `name` returns a variable's name; the
/// variable may be gone since.
std::string describe(const SolverProblem& problem, const FactorGraph& graph,
                     const std::function<std::string(VariableId)>& name);

}  // namespace motorcade
