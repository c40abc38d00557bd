#pragma once

#include <vector>

#include "backend/elimination/elimination_tree.hpp"
#include "backend/graph/factor_graph.hpp"

namespace motorcade {

/// A scalar among a clique's frontals.
struct FrontalScalar {
  int clique = 0, column = 0;
};

/// Direction of the whole system that (nearly) no factor constrains. It shows as a scalar that was eliminated with
/// (nearly) no information. That scalar moves by one, those eliminated later do not move, and those eliminated earlier
/// move so that the cost rises least.
struct NullSpaceDirection {
  struct Step {
    VariableId variable;
    SmallVector step;  // in the world's axes
  };
  enum class Constraint {
    kNone,      // no factor's cost changes along the direction
    kWeak,      // some factor's cost rises
    kNegative,  // the cost falls: information matrices are indefinite
  };
  VariableId held;          // whose scalar it is: the solver keeps it where it is
  std::vector<Step> steps;  // of the variables that move
  Constraint constraint = Constraint::kNone;
};

/// Scalars of a clique whose pivots were found singular, or are smaller than `ratio` times their diagonal entries
/// before elimination.
std::vector<FrontalScalar> weakScalars(const EliminationTree& tree, int clique, double ratio);

/// Finds the direction of a scalar. Costs as much as the part of the tree that moves.
NullSpaceDirection nullSpaceDirection(const FactorGraph& graph, const EliminationTree& tree,
                                      const FrontalScalar& scalar);

}  // namespace motorcade
