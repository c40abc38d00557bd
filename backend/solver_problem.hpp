#pragma once

#include <functional>
#include <string>
#include <vector>

#include "backend/factor_graph.hpp"

namespace motorcade {

/// What is wrong with a graph, found by an update.
struct SolverProblem {
  enum class Kind {
    kUnconstrained,      // no factor constrains the variable along `direction`: its estimate stays where it is
    kBadlyConditioned,   // the factors constrain it by so little, compared with their size, that rounding eats the result
    kNotFinite,          // the factor has NaN or infinity at its variables' estimates: it was left out
    kUnknownVariable,    // the factor names a variable that is not in the graph: it was left out
    kRepeatedVariable,   // the factor names a variable twice: it was left out
  };
  Kind kind = Kind::kUnconstrained;
  VariableId variable;
  SmallVector direction;            // of unit length, in the variable's own perturbation; empty where it does not apply
  std::vector<FactorId> factors;    // that touch the variable
  std::int64_t part_variables = 0;  // in the connected part of the graph that the variable belongs to; the whole part may be free to move
};

/// A sentence, with `name` giving the variable's name: "pose 17 is not constrained along y (0.8) and yaw (0.6); ...".
std::string describe(const SolverProblem& problem, const FactorGraph& graph, const std::function<std::string(VariableId)>& name);

}  // namespace motorcade
