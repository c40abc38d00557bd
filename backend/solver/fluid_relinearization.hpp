#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "backend/elimination/elimination_tree.hpp"
#include "backend/graph/mark_set.hpp"
#include "backend/solver/back_substitution.hpp"
#include "backend/solver/clique_work.hpp"
#include "backend/solver/elimination_budget.hpp"

namespace motorcade {

/// Fluid relinearization: finds the linear models that are off after a step, and corrects them in the next one.
///
/// Residuals and Jacobians are corrected apart. Where a residual is off, its right-hand side is corrected, which costs
/// a substitution. Where variables have turned since their Jacobians were taken, these are taken anew, which costs an
/// elimination of the cliques above. The worst come first, as far as the allowances and the budget reach.
class FluidRelinearization {
 public:
  /// Zero tolerances are exact.
  struct Params {
    /// Mismatch of a linear model, over the root mean square of the residuals.
    double mismatch_tolerance = 0.05;
    double compared_share = 0.25;  // of it, as a bound for one variable: below, its factors need no look
    /// Summed mismatch of a factor at which its variables are relinearized.
    double jacobian_drift_sigmas = 0.5;
    /// Turn of a variable at which it is relinearized as soon as possible, and from which on at leisure.
    double relinearize_rad = 0.05, leisurely_rad = 0.005;
    double urgent_flops = 4e7;  // allowance per step for relinearization as soon as possible
    double polish_flops = 2e6;  // and at leisure
    /// Share of the leisurely turn at which a variable at rest is relinearized, too, and what a step adds to the
    /// allowance for that. Only for a limited allowance.
    double rest_share = 0.2, rest_flops = 4e3;
  };
  struct Corrections {
    int relinearized_variables = 0, relinearized_factors = 0, corrected_factors = 0;
  };

  FluidRelinearization(const Params& params, FactorGraph& graph, const EliminationTree& tree,
                       const BackSubstitution& substitution, CliqueWork& work, EliminationBudget& budget)
      : params_(params), graph_(graph), tree_(tree), substitution_(substitution), work_(work), budget_(budget) {}

  /// Finds the models that are off after a step.
  void compareModels(const BackSubstitution::Result& step);
  /// Begins a step. Neither the new factors nor those that wait are in the tree yet.
  void beginStep(std::span<const FactorId> new_factors, std::span<const FactorId> waiting);
  /// Corrects the models that are off, as far as the budget reaches, and marks the cliques' work.
  /// `in_any_case`: corrects at least one residual, whatever its way to the root costs.
  Corrections correctModels(bool in_any_case = false);
  /// Forgets everything, as all has been relinearized.
  void clear();

  bool anyModelOff() const { return !off_.empty(); }
  /// Largest mismatch of the models that were found to be off, in standard deviations.
  double worstMismatch() const {
    double worst = 0;
    for (const OffModel& off : off_) worst = std::max(worst, off.mismatch);
    return worst;
  }
  /// True when the budget put residuals off.
  bool correctionsWait() const { return corrections_wait_; }
  /// Number of variables whose relinearization was put off.
  std::size_t deferred() const { return stale_.size(); }

 private:
  struct OffModel {
    FactorId factor;
    double mismatch = 0;
  };
  struct Stale {
    double turn_rad = 0;
    VariableId variable;
  };
  /// Outcome of a relinearization under the allowances and the budget.
  enum class Reach : char { kWithin, kBeyondAllowance, kBeyondBudget };
  /// The allowances count the cliques' volume, apart from the budget.
  struct Cost {
    CliqueCost work;
    double volume = 0;
  };

  void lookAt(VariableId v);
  void compare(FactorId f);
  void compareThoseThatFollowed(std::span<const int> solved);
  void markStale(VariableId v, double turn_rad);
  bool isStale(VariableId v) const { return staleness_rad_[v.value] > 0; }
  void markDrifted();
  void relinearizeStale();
  void relinearizeWhatIsFree();
  Reach relinearizeWorst();
  void relinearizeAtRest();
  Reach relinearizeRegion(VariableId worst, double worst_turn_rad, double& flops_left);
  Reach relinearizeWithin(VariableId v, double& flops_left);
  Cost costOfRelinearizing(VariableId v, double most_volume);
  bool isFree(VariableId v) const;
  void relinearize(VariableId v);
  void correctResiduals();
  bool waitsForJacobians(const OffModel& off) const;
  bool reachesResidual(FactorId id);
  void correctResidual(FactorId id);

  Params params_;
  FactorGraph& graph_;
  VariableStates& states_ = graph_.states();
  LinearModels& models_ = graph_.models();
  const EliminationTree& tree_;
  const BackSubstitution& substitution_;
  CliqueWork& work_;
  EliminationBudget& budget_;
  double tolerance_ = 0;                // of a mismatch, in the comparison at hand
  std::vector<VariableId> to_look_at_;  // that moved
  std::vector<char> half_followed_;     // per factor: to be compared when all of its variables have followed
  std::vector<OffModel> off_;           // models to correct in the next step
  std::vector<VariableId> stale_;       // whose linearization points are off
  std::vector<Stale> ranked_;           // the same with how far they are off; scratch
  std::vector<double> staleness_rad_;   // per variable: its turn when it became stale, 0 when it is not
  int next_at_rest_ = 0;                // variable to look at
  double rest_flops_left_ = 0;          // saved up by the steps so far
  bool corrects_in_any_case_ = false, corrections_wait_ = false;
  Corrections corrections_;  // of the step at hand
  std::vector<FactorId> relinearized_;
  MarkSet compared_, new_factors_, outside_tree_, is_relinearized_, corrected_;  // factors
  std::vector<VariableId> region_;
  MarkSet in_region_;  // variables
  MarkSet counted_;    // cliques
};

}  // namespace motorcade
