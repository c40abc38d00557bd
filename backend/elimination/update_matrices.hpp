#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include "backend/elimination/elimination_tree.hpp"
#include "backend/elimination/front.hpp"
#include "backend/graph/block_pool.hpp"

namespace motorcade {

/// Memory of the cliques' update matrices. They are most of a tree's memory, and needed only where the parent is
/// eliminated anew without the clique: near the root always, farther down hardly ever. Old ones are given back, and
/// made again where a front gathers them.
class UpdateMatrices {
 public:
  /// Update matrices are old when their clique has kept its place for over `kept_eliminations`; with 0 all are kept, as
  /// they are while they hold no more than `kept_bytes`.
  UpdateMatrices(EliminationTree& tree, Front& front, int kept_eliminations, std::size_t kept_bytes = 0)
      : tree_(tree), front_(front), kept_eliminations_(kept_eliminations), kept_bytes_(kept_bytes) {}

  void beginElimination() { ++eliminations_; }
  /// Notes that the clique was hung below its parent.
  void noteAttached(int clique);
  void giveBackOld();

  /// Takes memory for a clique that has none.
  void take(Clique& clique) { clique.update_matrix = memory_.take(clique.updateMatrixLength()); }
  /// Takes memory for a clique that may have it still.
  void takeAgain(Clique& clique);
  void giveBack(Clique& clique);
  /// Calls `enlarge(to, from)` to bring a matrix to the clique's present length: in place, or from one block to
  /// another.
  template <class Grow>
  void grow(Clique& clique, const Grow& enlarge) {
    double* const former = clique.update_matrix;
    const bool stays = BlockPool::fits(former, clique.updateMatrixLength());
    if (!stays) clique.update_matrix = memory_.takeToGrow(clique.updateMatrixLength());
    enlarge(clique.update_matrix, former);
    if (!stays) memory_.give(former);
  }

  /// Makes the missing matrices again that the clique's front gathers.
  void makeBelow(const Clique& clique);
  /// Gives them back, but not those of cliques attached just now, which are near the root and will be gathered again.
  void giveBackMadeAgainBelow(const Clique& clique);

  std::size_t heldBytes() const { return memory_.heldBytes(); }

 private:
  struct Attached {
    std::int64_t when;
    int clique;
  };

  bool mayGiveBack(int clique) const;
  int depthWithout(int clique) const;

  EliminationTree& tree_;
  Front& front_;
  int kept_eliminations_;
  std::size_t kept_bytes_;
  std::int64_t eliminations_ = 0;
  std::deque<Attached> attached_;  // cliques with update matrices, in that order; some have left
  BlockPool memory_;
};

}  // namespace motorcade
