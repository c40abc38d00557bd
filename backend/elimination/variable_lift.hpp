#pragma once

#include <vector>

#include "backend/elimination/elimination_tree.hpp"
#include "backend/elimination/update_matrices.hpp"
#include "backend/graph/factor_graph.hpp"

namespace motorcade {

/// Moves a variable up the tree, to a later place in the elimination order, without an elimination. What R says as a
/// whole stays.
///
/// Only the rows [R S d] of the variable and of those that are now eliminated before it change. The former are added to
/// the latter by reflections, and what is left over are the variable's new rows. Where the variable was a frontal, it
/// joins the separator, and the update matrix gains its rows' product. The cost is the area of the matrices times the
/// variable's size. All scalars of the cliques must have information.
class VariableLift {
 public:
  VariableLift(const FactorGraph& graph, EliminationTree& tree, BlockPool& panels, UpdateMatrices& update_matrices)
      : graph_(graph), tree_(tree), panels_(panels), update_matrices_(update_matrices) {}

  /// Makes a frontal variable the last one of its clique's frontals.
  void moveToEnd(int clique, VariableId v);
  /// Makes the last frontal variable of a clique the last one of its parent's. Where the clique is left without
  /// frontals, it has to be removed.
  void moveToParent(int clique);

 private:
  void takeRows(const Clique& clique, int count);
  void takeIn(Clique& parent, const Clique& clique, int count);
  void moveFactors(int clique);
  void passOn(Clique& clique, int count);
  void leaveOut(Clique& clique, FactorId factor);

  const FactorGraph& graph_;
  EliminationTree& tree_;
  BlockPool& panels_;
  UpdateMatrices& update_matrices_;
  std::vector<FactorId> moved_;  // with the variable
  // Scratch.
  std::vector<double> rows_;   // of the variable, transposed
  std::vector<double> added_;  // the same in the rows of a front
  std::vector<int> row_;       // per scalar of a factor: its row in the separator
  std::vector<double> product_;
};

}  // namespace motorcade
