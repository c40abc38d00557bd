#pragma once

#include <span>
#include <vector>

#include "backend/elimination/eliminator.hpp"
#include "backend/graph/mark_set.hpp"
#include "backend/solver/elimination_budget.hpp"

namespace motorcade {

/// Spreads loop closures over updates. A factor on a variable of long ago asks for the elimination of all cliques from
/// there up to the root. If that exceeds the budget, the factor waits in the graph, outside of the tree, while its
/// variables are lifted a few cliques per update. R stays that of the same problem, and in the end the factor asks for
/// little.
class WaitingFactors {
 public:
  WaitingFactors(FactorGraph& graph, const EliminationTree& tree, Eliminator& eliminator, EliminationBudget& budget)
      : graph_(graph), tree_(tree), eliminator_(eliminator), budget_(budget) {}

  /// Leaves those new factors in `fresh` that the next elimination takes in, and adds the ones that waited long enough.
  /// The cliques of the `touched` variables are eliminated anew in any case. With `corrections_first`, factors that
  /// wait come no nearer.
  void admit(std::vector<FactorId>& fresh, std::span<const VariableId> touched, bool corrections_first);
  /// Takes the waiting factors with one of the variables, which are to leave.
  std::vector<FactorId> takeWith(std::span<const VariableId> variables);
  /// Removes a factor; false when it does not wait.
  bool remove(FactorId id) { return std::erase(waiting_, id) > 0; }
  /// Forgets all, as the tree has taken in everything.
  void clear() { waiting_.clear(); }

  const std::vector<FactorId>& factors() const { return waiting_; }
  /// Sum of their squared residuals at the estimates. Where all else has settled, chi2 is at most this far above its
  /// minimum: without these factors it would be there.
  double chi2() const;

 private:
  bool allows(const CliqueCost& cost) const {
    return cost.scalars <= allowance_.scalars && cost.flops <= allowance_.flops;
  }
  void mark(VariableId v);
  bool isNew(VariableId v) const { return tree_.cliqueOf(v) < 0; }
  CliqueCost costOf(FactorId id);
  std::int64_t scalarsAbove(VariableId v) const;
  bool canWait(FactorId id) const;
  void admitFresh(std::vector<FactorId>& fresh);
  void admitWaiting(std::vector<FactorId>& fresh);
  bool admit(FactorId id, const CliqueCost& cost, std::vector<FactorId>& fresh);
  void accept(FactorId id, const CliqueCost& cost);
  enum class Lift : char { kDone, kBeyondAllowance, kNone };  // the last: there is nothing above to lift through
  Lift liftVariableOf(FactorId id, std::size_t least);

  FactorGraph& graph_;
  const EliminationTree& tree_;
  Eliminator& eliminator_;
  EliminationBudget& budget_;
  std::vector<FactorId> waiting_;  // in the order they came
  CliqueCost allowance_;           // of the update at hand
  MarkSet marked_, counted_;       // cliques that are eliminated anew; scratch
  MarkSet held_;                   // new variables that a factor holds in all dimensions
  MarkSet puts_off_;               // factors
};

}  // namespace motorcade
