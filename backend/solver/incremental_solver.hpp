#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "backend/elimination/affected_order.hpp"
#include "backend/elimination/elimination_tree.hpp"
#include "backend/graph/factor_graph.hpp"
#include "backend/solver/problem_reporter.hpp"
#include "backend/solver/solver_problem.hpp"
#include "core/messages.hpp"

namespace motorcade {

/// Incremental square-root smoothing (iSAM, Kaess et al. 2008, on the tree of iSAM2, 2012): keeps R of the linearized
/// problem as a tree of cliques; an update eliminates anew only the cliques from where new factors enter up to the
/// root.
///
/// Fluid relinearization tells residuals from Jacobians. After each step the linear models of the factors whose
/// variables moved are compared with the factors themselves; where a residual is off, its right-hand side is corrected,
/// which costs a substitution. Where variables have turned since their Jacobians were taken, these are taken anew and
/// the cliques above eliminated again, the worst first, as far as the budget reaches.
///
/// Add variables and factors, then `update`. `retire` and `drop` want no additions waiting.
class IncrementalSolver {
 public:
  enum class Policy {
    kEveryN,  // keeps the order and the linear models between batch steps, every `batch_every_updates` (iSAM)
    kFluid,   // corrects the models that are off and reorders what an update touches
  };
  struct Params {
    Policy policy = Policy::kFluid;
    int batch_every_updates = 50;
    // Of kFluid. Zero tolerances are exact.
    double mismatch_tolerance = 0.05;    // of a linear model, over the root mean square of the residuals
    double jacobian_drift_sigmas = 0.5;  // summed mismatch of a factor at which its variables are relinearized
    double relinearize_rad =
        0.05;  // turn of a variable at which it is relinearized as soon as possible; from a fifth of it on, at leisure
    double substitution_tolerance =
        0.05;  // steps below that, in conditional standard deviations over the same mean, do not spread
    double urgent_flops = 4e7;      // allowance per update for relinearization as soon as possible
    double polish_flops = 1e6;      // and at leisure
    int iterations_per_update = 2;  // Gauss-Newton steps at most, while models are off
    std::int64_t iterated_scalars =
        3000;                         // substituted in an update, up to which it may take a further step; 0: no limit
    std::int64_t budget_scalars = 0;  // eliminated per update beyond what the new factors ask for; 0: no limit
    double budget_ms =
        0;  // the same as time, at the pace of the updates before, so results depend on the machine; 0: no limit
  };
  struct Report {
    std::vector<SolverProblem> problems;
    std::vector<VariableId> moved;  // whose estimates changed by more than the substitution threshold
    std::int64_t eliminated_scalars = 0, substituted_scalars = 0;
    int relinearized_variables = 0, relinearized_factors = 0, corrected_factors = 0;
    int deferred_variables = 0;  // whose relinearization the budget put off
    double largest_change = 0;   // of any x, m or rad
  };

  explicit IncrementalSolver(const Params& params) : params_(params) {}
  IncrementalSolver(const IncrementalSolver&) = delete;  // its parts refer to each other
  IncrementalSolver& operator=(const IncrementalSolver&) = delete;

  VariableId addVariable(const Value& initial);
  /// Empty when the factor cannot be used; the next report says why.
  std::optional<FactorId> addFactor(std::unique_ptr<const Factor> factor);
  void removeFactor(FactorId id);
  /// The report lasts until the next change of the solver.
  const Report& update();

  /// Marginalizes variables: what they know stays as a factor on their neighbors, and the solution does not change.
  void retire(std::span<const VariableId> variables);
  /// Removes variables with all that was measured of them.
  const Report& drop(std::span<const VariableId> variables);
  /// Relinearizes everything until no x changes by more than `tolerance`.
  const Report& converge(int max_iterations, double tolerance);

  Value estimate(VariableId v) const { return graph_.estimate(v); }
  SE3 pose(VariableId v) const { return std::get<SE3>(estimate(v)); }
  /// Joint covariance of right perturbations of the variables, stacked, from R. Empty when the system is singular
  /// there.
  std::optional<Eigen::MatrixXd> jointCovariance(std::span<const VariableId> variables) const;

  /// In the counters, `relinearizations` are updates that relinearized anything; `reorderings` and `batch_solves`
  /// concern the whole system.
  SolverCounters counters() const;
  const FactorGraph& graph() const { return graph_; }
  const EliminationTree& tree() const { return tree_; }
  std::size_t heldBytes() const { return graph_.termBytes() + tree_.heldBytes(); }

 private:
  /// What a step does with a clique.
  enum class Work : char { kNone, kShift, kRefresh, kRemoved, kNew };
  /// How far the budget and the allowances reach.
  enum class Reach : char { kWithin, kBeyondAllowance, kBeyondBudget };
  struct OffModel {
    FactorId factor;
    double mismatch = 0;
  };
  struct RetiringPart;

  std::int64_t budget() const;
  void notePace(double update_ms);
  void beginReport();
  void endReport();
  bool mayIterate() const;
  void step(bool fold);
  void batchStep();

  void markWork(int clique, Work work);
  void markTouched();
  void workThroughDirtyCliques();
  void rebuildTop();
  void substitute();
  void solve(const Clique& clique);

  double rmsResidual() const;
  void compareModels();
  void markStale(VariableId v, double turn_rad);
  void correctModels();
  void relinearizeStale();
  Reach relinearizeRegion(VariableId worst, double& flops_left);
  Reach relinearizeWithin(VariableId v, double& flops_left);
  bool isStale(VariableId v) const;
  struct EliminationWork {
    std::int64_t scalars = 0;
    double flops = 0;
  };
  EliminationWork workOfRelinearizing(VariableId v);
  void relinearize(VariableId v);
  bool isNew(FactorId f) const;
  void shiftResidual(FactorId id);

  bool usable(const Factor& factor);
  std::vector<int> withAncestors(std::vector<int> cliques) const;

  std::vector<RetiringPart> partsWith(std::span<const VariableId> variables) const;
  void retirePart(const RetiringPart& part, std::span<const VariableId> gone);

  Params params_;
  FactorGraph graph_;
  EliminationTree tree_{graph_};
  AffectedOrder reordered_{graph_, tree_};
  Report report_;
  SolverCounters counters_;
  double scalars_per_ms_ = 0;                         // with `budget_ms`: of the updates so far; 0 before the first
  std::int64_t budget_left_ = 0, saved_scalars_ = 0;  // saved for a variable that costs more than the budget
  std::vector<SolverProblem> refused_;                // since the last update
  SolverExplanations explanations_;

  std::vector<VariableId> touched_, new_variables_;
  std::vector<FactorId> new_factors_;
  std::vector<OffModel> off_;      // models to correct in the next step
  std::vector<VariableId> stale_;  // whose linearization points are off
  std::vector<double> staleness_;  // per variable: its turn [rad] when it became stale, 0 when it is not

  // Of the step at hand.
  std::uint32_t step_ = 0;
  double spread_sigmas_ = 0;
  std::vector<Work> work_;  // per clique
  std::vector<int> dirty_;  // cliques to shift or refresh
  std::vector<int> removed_cliques_, created_;
  EliminationTree::Removed removed_;
  std::vector<std::size_t> change_begin_;  // per clique: where its right-hand side's change lies in `changes_`
  std::vector<double> changes_;
  std::vector<VariableId> moved_;
  std::vector<std::uint32_t> moved_in_step_, checked_in_step_,
      relinearized_in_step_;            // per variable, per factor, per factor
  std::vector<std::uint32_t> counted_;  // per clique
  std::uint32_t count_mark_ = 0;
  std::vector<FactorId> relinearized_;
  std::vector<VariableId> region_;
  std::vector<std::uint32_t> in_region_;  // per variable
  std::uint32_t region_mark_ = 0;
  std::vector<int> open_;  // cliques to solve
  std::vector<double> x_separator_, x_frontal_;
};

}  // namespace motorcade
