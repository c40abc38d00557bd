#pragma once

#include <vector>

#include "backend/elimination/elimination_tree.hpp"

namespace motorcade {

/// A scalar among a clique's frontals.
struct FrontalScalar {
  int clique = 0, column = 0;
};

/// How a graph moves along what a scalar's elimination found without information: the scalar by one, those that are
/// eliminated later not at all, those eliminated earlier so that the cost rises least.
struct NullMotion {
  struct Step {
    VariableId variable;
    SmallVector step;  // in the world's axes
  };
  enum class Seen {
    kByNone,    // no factor's cost changes
    kByFew,     // some factor's does
    kNegative,  // the cost falls: information matrices are indefinite
  };
  VariableId held;
  std::vector<Step> steps;  // of those that move, the held variable first
  Seen seen = Seen::kByNone;
};

/// Scalars of a clique whose pivots were found singular, or have lost against their diagonal entries by more than
/// `ratio`.
void appendWeakScalars(const EliminationTree& tree, int clique, double ratio, std::vector<FrontalScalar>& found);

/// Costs as much as the part of the tree that moves.
NullMotion nullMotion(const FactorGraph& graph, const EliminationTree& tree, const FrontalScalar& scalar);

}  // namespace motorcade
