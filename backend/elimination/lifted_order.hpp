#pragma once

#include <span>
#include <vector>

#include "backend/elimination/elimination_tree.hpp"
#include "backend/elimination/ordering.hpp"
#include "backend/graph/factor_graph.hpp"
#include "backend/graph/mark_set.hpp"

namespace motorcade {

/// Orders the variables of a part of the tree such that some are lifted: they come last, and before them the others,
/// the nearer the later. What comes near a lifted variable in the next measurements then stands high, too.
class LiftedOrder {
 public:
  explicit LiftedOrder(const FactorGraph& graph, const EliminationTree& tree) : graph_(graph), tree_(tree) {}

  /// Of the variables in `part`, which `boundary` separates from what stays above; some of them are `lifted`, the first
  /// one to the very end. The result lasts until the next call.
  std::span<const VariableId> operator()(const EliminationTree::Removed& part, std::span<const VariableId> boundary,
                                         std::span<const VariableId> lifted);

 private:
  void collectTerms(const EliminationTree::Removed& part, std::span<const VariableId> boundary);
  void addTerm(std::span<const VariableId> variables);
  void bandByDistance(std::span<const VariableId> lifted);

  const FactorGraph& graph_;
  const EliminationTree& tree_;
  Ordering ordering_;
  std::vector<VariableId> order_;
  int columns_ = 0;             // the variables of the part come first, then the boundary
  std::vector<int> column_of_;  // per variable; of those in `known_`
  MarkSet known_;
  std::vector<int> entries_, begin_;           // columns of each term, and where they begin
  std::vector<int> terms_, terms_begin_;       // terms of each column, and where they begin
  std::vector<int> group_, distance_, queue_;  // per column; columns
  MarkSet passed_;                             // terms
};

}  // namespace motorcade
