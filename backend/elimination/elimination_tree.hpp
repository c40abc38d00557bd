#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "backend/elimination/elimination_pattern.hpp"
#include "backend/graph/block_pool.hpp"
#include "backend/graph/factor_graph.hpp"

namespace motorcade {

/// A group of variables that are eliminated together: p(frontals | separator) in square-root form. Matrices are
/// column-major, their leading dimensions padded to a multiple of 4.
struct Clique {
  int parent = -1, first_child = -1, next_sibling = -1, previous_sibling = -1;
  std::vector<VariableId> variables;  // frontals, then the separator
  std::vector<int> row_in_parent;     // per variable of the separator: its first scalar among the parent's
  std::vector<FactorId> factors;      // whose first variable in elimination order is a frontal
  int frontals = 0;
  int frontal_size = 0, size = 0;  // scalars: of the frontals, of all variables
  /// (size + 1) x frontal_size: columns are the rows of [R S d], so R^T above, S^T, and d^T last.
  double* panel = nullptr;
  std::vector<int> singular;  // frontal scalars without information
  /// What elimination leaves on the separator: H, its lower triangle packed column by column, and g.
  double *remainder = nullptr, *carry = nullptr;
  bool alive = false;

  std::span<const VariableId> frontalVariables() const {
    return {variables.data(), static_cast<std::size_t>(frontals)};
  }
  std::span<const VariableId> separator() const {
    return std::span(variables).subspan(static_cast<std::size_t>(frontals));
  }
  int separatorSize() const { return size - frontal_size; }
  int panelStride() const { return (size + 1 + 3) / 4 * 4; }
  /// Such that [row] is the entry of the column, from the diagonal on.
  const double* remainderColumn(int j) const {
    return remainder + std::ptrdiff_t{j} * (2 * separatorSize() - j - 1) / 2;
  }
};

/// Which variables to eliminate, in which order. The roots that result hang below `parent`, in whose clique the
/// `boundary` lies.
struct Elimination {
  std::span<const VariableId> order, boundary;
  std::span<const FactorId> factors;  // each with a variable in `order`, all in `order` and `boundary`
  std::span<const int> orphans;  // cliques whose separators lie in `order` and `boundary`, with a variable in `order`
  int parent = -1;
  bool renumber = true;  // false: the variables keep their places in the order of the whole
};

/// A scalar that no factor constrains; its x stays where the estimate stands.
struct SingularScalar {
  VariableId variable;
  int component = 0;
};

/// R as a tree of cliques (the Bayes tree of Kaess et al. 2012): new information touches only the cliques from where it
/// enters up to the root. Works on the factors' linear models in `graph`.
class EliminationTree {
 public:
  explicit EliminationTree(const FactorGraph& graph) : graph_(graph) {}

  const Clique& operator[](int clique) const { return cliques_[clique]; }
  /// The clique that has the variable among its frontals, -1 if none.
  int cliqueOf(VariableId v) const;
  /// The clique that a factor belongs to.
  int ownerOf(const Factor& factor) const;
  /// Appends the cliques with the variable among their frontals or in their separator.
  void appendCliquesWith(VariableId v, std::vector<int>& found) const;
  const std::vector<int>& roots() const { return roots_; }
  std::size_t slots() const { return cliques_.size(); }
  /// Place in the elimination order: children come before parents.
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
  /// Eliminates a clique anew, after its children: the linear models of its factors or what its children carry changed.
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
  const std::vector<SingularScalar>& singular() const { return singular_; }
  struct WeakPivot {
    VariableId variable;
    double ratio = 1;  // of the pivot to its diagonal before elimination
  };
  const WeakPivot& weakestPivot() const { return weakest_; }
  void clearFindings();

  std::int64_t eliminatedScalars() const { return eliminated_scalars_; }  // ever
  std::size_t heldBytes() const { return pool_.heldBytes(); }
  std::size_t usedBytes() const { return pool_.usedBytes(); }

 private:
  int newClique();
  void release(Clique& clique);
  void layOut(Clique& clique);
  void eliminateFront(Clique& clique);
  struct RowSpan {
    int from, to, size;  // scalars from `from` of a small matrix go to `to` of the front
  };
  template <class ColumnOf>
  void addSymmetric(Clique& clique, const ColumnOf& source, std::span<const RowSpan> spans);
  void packRemainder(Clique& clique) const;
  void splitAtFrontals(int frontal_size);
  void holdSingular(Clique& clique, int column);
  void addFactorTo(Clique& clique, FactorId id);
  void addChildTo(Clique& clique, const Clique& child);
  double* column(Clique& clique, int column);

  const FactorGraph& graph_;
  std::vector<Clique> cliques_;
  std::vector<int> free_, roots_;
  std::vector<int> clique_of_;          // per variable
  std::vector<std::int64_t> sequence_;  // per variable
  std::int64_t next_sequence_ = 0, eliminated_scalars_ = 0;
  BlockPool pool_;
  EliminationPattern pattern_;
  std::vector<SingularScalar> singular_;
  WeakPivot weakest_;
  // Scratch.
  std::vector<int> offset_;  // per variable: first scalar in the front at hand
  std::vector<RowSpan> spans_;
  std::vector<double> product_, former_;
  /// Of the front at hand, [H g; g^T c] on the separator, until it is packed.
  std::vector<double, Eigen::aligned_allocator<double>> remainder_;
  int remainder_stride_ = 0;
  std::vector<int> scalars_, term_positions_, group_clique_;
  std::vector<char> leaving_;  // per clique
};

}  // namespace motorcade
