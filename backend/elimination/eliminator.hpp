#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "backend/elimination/clique_cost.hpp"
#include "backend/elimination/elimination_pattern.hpp"
#include "backend/elimination/elimination_tree.hpp"
#include "backend/elimination/front.hpp"
#include "backend/elimination/update_matrices.hpp"
#include "backend/elimination/variable_lift.hpp"
#include "backend/graph/block_pool.hpp"
#include "backend/graph/factor_graph.hpp"

namespace motorcade {

/// Variables to eliminate, in their order. The new roots, and orphans without a variable in `order`, hang below
/// `parent`, whose clique holds the `boundary`.
struct Elimination {
  std::span<const VariableId> order, boundary = {};
  std::span<const FactorId> factors;  // each with a variable in `order`, all in `order` and `boundary`
  std::span<const int> orphans = {};  // cliques whose separators lie in `order` and `boundary`
  int parent = -1;
  bool renumber = true;  // false: the variables keep their positions in the order of the whole
};

/// Eliminates variables of a graph into cliques of a tree, from the linear models of the factors, and keeps the
/// cliques' matrices up to date.
class Eliminator {
 public:
  /// Update matrices of cliques that kept their place for `kept_eliminations` are given back, and made again for a
  /// front that gathers them. With 0 all are kept, as they are while they hold no more than `kept_bytes`.
  Eliminator(const FactorGraph& graph, EliminationTree& tree, int kept_eliminations = 0, std::size_t kept_bytes = 0)
      : graph_(graph),
        tree_(tree),
        front_(graph, tree),
        update_matrices_(tree, front_, kept_eliminations, kept_bytes) {}
  Eliminator(const Eliminator&) = delete;  // its parts refer to each other
  Eliminator& operator=(const Eliminator&) = delete;

  /// Eliminates, and returns the new cliques, parents before children; they last until the next call.
  std::span<const int> eliminate(const Elimination& problem);
  /// Moves a variable up the tree: it becomes the last of the variables of these cliques, its own and the next ones
  /// above it. What R says stays, and nothing above the cliques changes. Returns false, and does nothing, when the
  /// order has no room left there or a scalar has no information. See VariableLift.
  bool lift(VariableId v, std::span<const int> cliques);
  /// See EliminationTree.
  EliminationTree::Removed& remove(std::span<const int> cliques);
  /// Eliminates a clique anew, after its children, as the linear models of its factors or its children's contributions
  /// changed.
  void refresh(int clique);
  /// Adds `change` to the right-hand side of a clique's front. What that leaves on the separator is added to
  /// `parent_change` (empty: nowhere), in the rows of the parent's front.
  void shiftRightHandSide(int clique, std::span<double> change, std::span<double> parent_change);
  /// Returns [H g; g^T c], lower triangle, that factors leave on `separator` when `eliminated` are eliminated from them
  /// alone. The tree stays.
  Eigen::MatrixXd marginal(std::span<const VariableId> eliminated, std::span<const VariableId> separator,
                           std::span<const FactorId> factors);

  /// The smallest pivot over its diagonal entry before elimination since the last reset, at most 1; 0 where a scalar
  /// had no information.
  double weakestPivot() const { return weakest_pivot_; }
  void resetWeakestPivot() { weakest_pivot_ = 1; }
  std::int64_t eliminatedScalars() const { return eliminated_scalars_; }  // ever
  double flops() const { return flops_; }                                 // of eliminations and lifts, ever
  std::size_t factorBytes() const { return pool_.usedBytes(); }           // of R and what it leaves over
  std::size_t heldBytes() const { return pool_.heldBytes() + update_matrices_.heldBytes(); }

 private:
  void findPattern(const Elimination& problem);
  int addClique(const Elimination& problem, const EliminationPattern::Group& group);
  void attach(int clique, int parent);
  void layOut(Clique& clique);
  void release(Clique& clique);
  void dissolve(int clique);

  const FactorGraph& graph_;
  EliminationTree& tree_;
  Front front_;
  UpdateMatrices update_matrices_;
  BlockPool pool_;  // apart: panels stay for as long as their variables, most update matrices do not
  VariableLift lift_{graph_, tree_, pool_, update_matrices_};
  EliminationPattern pattern_;
  std::int64_t eliminated_scalars_ = 0;
  double flops_ = 0;
  double weakest_pivot_ = 1;
  // Scratch.
  std::vector<int> position_;  // per variable: in the elimination at hand, or its first scalar in a clique
  std::vector<double> former_;
  std::vector<int> scalars_, term_positions_, created_, inside_, outside_;
  std::vector<VariableId> variables_;
};

}  // namespace motorcade
