#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "backend/elimination/clique.hpp"

namespace motorcade {

/// R as a tree of cliques (the Bayes tree of Kaess et al. 2012): new information touches only the cliques from where it
/// enters up to the root. Holds the variables and factors of each clique, the links between cliques, and the
/// elimination order. An Eliminator adds cliques and computes their matrices.
class EliminationTree {
 public:
  const Clique& operator[](int clique) const { return cliques_[clique]; }
  Clique& operator[](int clique) { return cliques_[clique]; }
  /// The clique that has the variable among its frontals, -1 if none.
  int cliqueOf(VariableId v) const {
    return static_cast<std::size_t>(v.value) < clique_of_.size() ? clique_of_[v.value] : -1;
  }
  /// The clique that a factor over these variables belongs to.
  int ownerOf(std::span<const VariableId> variables) const;
  /// Appends the cliques with the variable among their frontals or in their separator.
  void appendCliquesWith(VariableId v, std::vector<int>& found) const;
  /// Returns the cliques and all above them, up to the roots, sorted.
  std::vector<int> withAncestors(std::vector<int> cliques) const;
  /// All cliques, in ascending order.
  std::vector<int> cliques() const;
  int rootOf(int clique) const;
  const std::vector<int>& roots() const { return roots_; }
  std::size_t slots() const { return cliques_.size(); }
  /// Position in the elimination order: children come before parents.
  std::int64_t sequence(int clique) const;

  /// Makes room for variables whose ids are below `slots`.
  void makeRoom(std::size_t slots);
  /// Makes the variables the last ones of the order.
  void appendToOrder(std::span<const VariableId> variables);
  /// Puts a variable behind those of a clique and before all that are above it. Returns false, and does nothing, when
  /// the order has no room left there.
  bool putBehind(VariableId v, int clique);
  /// Makes the last frontal variable of a clique the last one of its parent's frontals. Factors, rows and matrices are
  /// up to the caller.
  void moveFrontalUp(int clique);
  /// Forgets a variable that is gone; its id may be used again.
  void forget(VariableId v);

  /// Adds a clique of its own, without factors, children and matrices.
  int add(std::span<const VariableId> variables, int frontals);
  /// Hangs a clique below another one, or makes it a root where that is -1.
  void hang(int clique, int parent);
  /// Variables, factors and orphans of the cliques that `remove` took out.
  struct Removed {
    std::vector<VariableId> variables;  // in elimination order
    std::vector<FactorId> factors;
    std::vector<int> orphans;  // children that stay
  };
  /// Takes out cliques that hold all their ancestors up to some clique that stays or to the root. The result lasts
  /// until the next call.
  Removed& remove(std::span<const int> cliques);

  void addFactor(int owner, FactorId factor) { cliques_[owner].factors.push_back(factor); }
  void removeFactor(int owner, FactorId factor) { std::erase(cliques_[owner].factors, factor); }

 private:
  void cutOff(const Clique& clique);

  std::vector<Clique> cliques_;
  std::vector<int> free_, roots_;
  std::vector<int> clique_of_;          // per variable
  std::vector<std::int64_t> sequence_;  // per variable
  std::int64_t next_sequence_ = 0;
  Removed removed_;
  std::vector<char> leaving_;  // per clique; scratch
};

}  // namespace motorcade
