#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "backend/front.hpp"

namespace motorcade {

/// A group of variables that are eliminated together: p(frontals | separator) in square-root form.
struct Clique {
  int parent = -1;
  std::vector<int> children;
  std::vector<VariableId> variables;  // frontals, then the separator, each in elimination order
  int frontals = 0;
  int frontal_size = 0, size = 0;  // scalars: of the frontals, of all variables
  /// (size + 1) x frontal_size: columns are the rows of [R S d], so R^T above, S^T, and d^T last.
  Eigen::MatrixXd L;
  /// Information [H g; g^T c] that elimination leaves on the separator; lower triangle.
  LinearTerm remainder{.form = Factor::Form::kInformation, .matrix = {}};

  std::span<const VariableId> frontalVariables() const { return {variables.data(), static_cast<std::size_t>(frontals)}; }
  std::span<const VariableId> separator() const { return std::span(variables).subspan(static_cast<std::size_t>(frontals)); }
};

/// Which variables to eliminate, in which order. The roots that result hang below `parent`, in whose clique the `boundary` lies.
struct Elimination {
  std::vector<VariableId> order, boundary;
  std::vector<Contribution> contributions;
  int parent = -1;
};

/// A scalar that no factor constrains.
struct SingularScalar {
  VariableId variable;
  int component = 0;
};

/// R as a tree of cliques (the Bayes tree of Kaess et al. 2012): new information touches only the cliques from where it enters up to the
/// root.
class EliminationTree {
 public:
  const Clique& operator[](int clique) const { return cliques_[static_cast<std::size_t>(clique)]; }
  /// The clique that has the variable among its frontals, -1 if none.
  int cliqueOf(VariableId v) const;
  /// Cliques with the variable among their frontals or in their separator.
  std::vector<int> cliquesWith(VariableId v) const;
  const std::vector<int>& roots() const { return roots_; }
  /// Place of a variable in the elimination order: lower is earlier.
  std::int64_t sequence(VariableId v) const { return sequence_[static_cast<std::size_t>(v.value)]; }

  /// Takes out the cliques; those of their children that stay become orphans, which the caller passes to `eliminate`.
  /// The frontals are returned in elimination order.
  struct Removed {
    std::vector<VariableId> variables;
    std::vector<int> orphans;
  };
  Removed remove(std::span<const int> cliques);

  /// Adds the cliques of an elimination. Variables that keep their place in the order keep their sequence number (`renumber` false).
  struct Result {
    std::vector<int> cliques;  // parents before children
    std::vector<SingularScalar> singular;
    int eliminated_scalars = 0;
  };
  Result eliminate(const Elimination& problem, const FactorGraph& graph, bool renumber);

  /// Hangs an orphan below a clique that holds its whole separator.
  void attach(int orphan, int parent);
  /// The variable is gone; its id may be used again.
  void forget(VariableId v) { sequence_[static_cast<std::size_t>(v.value)] = -1; }

  /// Scalars held in L and remainders, a measure of memory.
  std::size_t storedScalars() const;

 private:
  struct Symbolic;
  Symbolic analyze(const Elimination& problem);
  int newClique();
  void fill(Clique& clique, std::span<const Contribution* const> contributions, const FactorGraph& graph, Result& result);

  std::vector<Clique> cliques_;
  std::vector<int> free_, roots_;
  std::vector<int> clique_of_;          // per variable
  std::vector<std::int64_t> sequence_;  // per variable, -1 before its first elimination
  std::vector<int> position_, offset_;  // scratch, per variable
  std::vector<double> workspace_;       // of the front at hand
  std::int64_t next_sequence_ = 0;
};

}  // namespace motorcade
