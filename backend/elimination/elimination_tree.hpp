#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "backend/elimination/clique.hpp"
#include "backend/elimination/elimination_pattern.hpp"
#include "backend/elimination/front.hpp"
#include "backend/graph/block_pool.hpp"
#include "backend/graph/factor_graph.hpp"

namespace motorcade {

/// Which variables to eliminate, in which order. The roots that result hang below `parent`, in whose clique the
/// `boundary` lies.
struct Elimination {
  std::span<const VariableId> order, boundary;
  std::span<const FactorId> factors;  // each with a variable in `order`, all in `order` and `boundary`
  std::span<const int> orphans;  // cliques whose separators lie in `order` and `boundary`, with a variable in `order`
  int parent = -1;
  bool renumber = true;  // false: the variables keep their positions in the order of the whole
};

/// R as a tree of cliques (the Bayes tree of Kaess et al. 2012): new information touches only the cliques from where it
/// enters up to the root. Works on the factors' linear models in `graph`.
class EliminationTree {
 public:
  /// Update matrices of cliques that hung where they are for so many eliminations are given back, and made again for a
  /// front that gathers them; with 0 all are kept.
  explicit EliminationTree(const FactorGraph& graph, int kept_eliminations = 0)
      : graph_(graph), kept_eliminations_(kept_eliminations) {}

  const Clique& operator[](int clique) const { return cliques_[clique]; }
  /// The clique that has the variable among its frontals, -1 if none.
  int cliqueOf(VariableId v) const;
  /// The clique that a factor over these variables belongs to.
  int ownerOf(std::span<const VariableId> variables) const;
  /// Appends the cliques with the variable among their frontals or in their separator.
  void appendCliquesWith(VariableId v, std::vector<int>& found) const;
  /// Sorted: the cliques and all above them, up to the roots.
  std::vector<int> withAncestors(std::vector<int> cliques) const;
  /// In ascending order.
  std::vector<int> cliques() const;
  int rootOf(int clique) const;
  const std::vector<int>& roots() const { return roots_; }
  std::size_t slots() const { return cliques_.size(); }
  /// Position in the elimination order: children come before parents.
  std::int64_t sequence(int clique) const;

  /// Takes out the cliques, which hold all their ancestors up to some clique that stays or to the root.
  struct Removed {
    std::vector<VariableId> variables;  // in elimination order
    std::vector<FactorId> factors;
    std::vector<int> orphans;  // children that stay
    void clear();
  };
  void remove(std::span<const int> cliques, Removed& removed);

  /// Adds the cliques of an elimination; they are appended to `created`, parents before children.
  void eliminate(const Elimination& problem, std::vector<int>& created);
  /// Moves a variable up the tree: of the variables of these cliques, its own and the next ones above it, it becomes
  /// the last one. What R says stays, and nothing above the cliques changes. False, and nothing is done, when the order
  /// has no room left there.
  bool lift(VariableId v, std::span<const int> cliques);
  /// Eliminates a clique anew, after its children: the linear models of its factors or what its children pass on
  /// changed.
  void refresh(int clique);
  /// Adds `change` to the right-hand side of a clique's front, and what that leaves on the separator to `parent_change`
  /// (empty: nowhere), in the rows of the parent's front.
  void shiftRightHandSide(int clique, std::span<double> change, std::span<double> parent_change);

  /// [H g; g^T c], lower triangle, that factors leave on `separator` when `eliminated` are eliminated from them alone;
  /// the tree stays.
  Eigen::MatrixXd marginal(std::span<const VariableId> eliminated, std::span<const VariableId> separator,
                           std::span<const FactorId> factors);

  void addFactor(int owner, FactorId factor) { cliques_[owner].factors.push_back(factor); }
  void removeFactor(int owner, FactorId factor);
  /// Hangs an orphan below a clique that holds its whole separator.
  void attach(int orphan, int parent);
  /// The variable is gone; its id may be used again.
  void forget(VariableId v);

  /// Scalars without information, and the smallest pivot over its diagonal, since the last call of `clearFindings`.
  const std::vector<SingularScalar>& singular() const { return front_.singular(); }
  const WeakPivot& weakestPivot() const { return front_.weakestPivot(); }
  void clearFindings() { front_.clearFindings(); }

  std::int64_t eliminatedScalars() const { return eliminated_scalars_; }  // ever
  std::size_t heldBytes() const { return pool_.heldBytes() + update_matrices_.heldBytes(); }
  std::size_t usedBytes() const { return pool_.usedBytes() + update_matrices_.usedBytes(); }

 private:
  std::int64_t sequenceAbove(int clique) const;
  void findPattern(const Elimination& problem);
  int addClique(const Elimination& problem, const EliminationPattern::Group& group);
  int takeSlot();
  void layOut(Clique& clique);
  void release(Clique& clique);
  void cutOff(const Clique& clique);
  void noteAttached(int clique);
  void giveBackOldUpdateMatrices();
  bool mayGiveBack(int clique) const;
  int depthWithout(int clique) const;
  void takeUpdateMatrix(Clique& clique);
  void giveBackUpdateMatrix(Clique& clique);
  void makeUpdateMatricesBelow(const Clique& clique);
  void giveBackThoseMadeAgainBelow(const Clique& clique);

  struct Attached {
    std::int64_t when;
    int clique;
  };

  const FactorGraph& graph_;
  int kept_eliminations_;
  std::vector<Clique> cliques_;
  std::vector<int> free_, roots_;
  std::vector<int> clique_of_;          // per variable
  std::vector<std::int64_t> sequence_;  // per variable
  std::int64_t next_sequence_ = 0, eliminations_ = 0, eliminated_scalars_ = 0;
  std::deque<Attached> attached_;     // cliques with update matrices, in that order; some have left
  BlockPool pool_, update_matrices_;  // apart: panels stay for as long as their variables, most update matrices do not
  EliminationPattern pattern_;
  Front front_{graph_};
  // Scratch.
  std::vector<int> position_;  // per variable: in the elimination at hand, or its first scalar in a clique
  std::vector<double> former_;
  std::vector<int> scalars_, term_positions_, group_clique_;
  std::vector<char> leaving_;  // per clique
};

}  // namespace motorcade
