#pragma once

#include <span>
#include <vector>

#include "backend/elimination/elimination_tree.hpp"
#include "backend/elimination/ordering.hpp"
#include "backend/graph/factor_graph.hpp"
#include "backend/graph/mark_set.hpp"

namespace motorcade {

/// Orders the variables that an update eliminates anew: with little fill, and later the nearer they are to the newest
/// measurements.
///
/// The next measurements will touch variables near those touched now: a vehicle drives on, and observes what lies close
/// to what it observed. Variables near the root are cheap to touch, so the order goes by bands of distance in the
/// factor graph, each twice as wide as the one before. Within a band, CCOLAMD orders for little fill. The newest
/// variables come last, with what very many factors share: their covariances, which everybody asks for, then cost next
/// to nothing.
class AffectedOrder {
 public:
  AffectedOrder(const FactorGraph& graph, const EliminationTree& tree) : graph_(graph), tree_(tree) {}

  /// Orders the `variables`; the `factors` and the separators of the `orphans` are the terms over them, and the
  /// `newest` are among the touched. The result lasts until the next call.
  std::span<const VariableId> operator()(std::span<const VariableId> variables, std::span<const FactorId> factors,
                                         std::span<const int> orphans, std::span<const VariableId> touched,
                                         std::span<const VariableId> newest = {});

 private:
  void bandByDistance(std::span<const VariableId> touched);
  void putLast(std::span<const VariableId> touched, std::span<const VariableId> newest);
  void addRow(std::span<const VariableId> variables);

  const FactorGraph& graph_;
  const EliminationTree& tree_;
  Ordering ordering_;
  std::span<const VariableId> variables_;
  std::vector<VariableId> order_;
  std::vector<int> column_of_;  // per variable; stale for those not at hand
  std::vector<int> row_, group_;
  std::vector<VariableId> queue_;
  std::vector<int> distance_;  // per variable: in the search at hand, if it was reached
  MarkSet reached_;            // variables
  MarkSet passed_;             // factors, which the search goes through once
};

}  // namespace motorcade
