#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "backend/factor_graph.hpp"

namespace motorcade {

/// A quadratic to be eliminated: a factor's, or what the cliques from `child` downwards left on their separator.
struct Contribution {
  std::span<const VariableId> variables;
  const LinearTerm* term = nullptr;
  int child = -1;
};

/// The sum of the contributions, lower triangle of [H g; g^T c] over `variables` in their order. `offset`, one per variable slot, receives
/// where each of them begins. The front is a view of `workspace`, which grows as needed.
using Front = Eigen::Map<Eigen::MatrixXd>;
Front assembleFront(std::span<const VariableId> variables, std::span<const Contribution> contributions, const FactorGraph& graph,
                    std::vector<int>& offset, std::vector<double>& workspace);

/// Square root of a dense front, the small dense matrix in which a clique's variables are eliminated. On entry the lower triangle of
/// `front` holds the information [H g; g^T c] of the eliminated variables, then their separator, then the right-hand side. On return the
/// first `eliminated` columns hold L with H = L L^T (the transposed rows of R), and the rest is what passes to the parent.
///
/// This gives the same R, up to signs, as a QR of the stacked Jacobian rows. A scalar that nothing constrains gets a unit pivot and no
/// coupling, so that its delta is zero; their list is returned.
std::vector<int> eliminateFront(Front& front, int eliminated);

}  // namespace motorcade
