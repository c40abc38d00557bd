#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "backend/elimination/affected_order.hpp"
#include "backend/elimination/eliminator.hpp"
#include "backend/graph/factor_graph.hpp"
#include "backend/solver/back_substitution.hpp"
#include "backend/solver/clique_work.hpp"
#include "backend/solver/elimination_budget.hpp"
#include "backend/solver/fluid_relinearization.hpp"
#include "backend/solver/problem_reporter.hpp"
#include "backend/solver/retirement.hpp"
#include "backend/solver/solver_problem.hpp"
#include "backend/solver/waiting_factors.hpp"
#include "core/messages.hpp"

namespace motorcade {

/// Incremental square-root smoothing (iSAM, Kaess et al. 2008, on the tree of iSAM2, 2012). Keeps R of the linearized
/// problem as a tree of cliques. An update eliminates anew only the cliques from where new factors enter up to the
/// root.
///
/// Add variables and factors, then `update`. Call `retire` and `drop` with no additions waiting.
class IncrementalSolver {
 public:
  enum class Policy {
    /// Keeps the order and the linear models between batch steps. These come every `batch_every_updates` (iSAM), and
    /// where very many variables come at once.
    kEveryN,
    kFluid,  // corrects the models that are off and reorders what an update touches
  };
  struct Params {
    Policy policy = Policy::kFluid;
    int batch_every_updates = 50;
    FluidRelinearization::Params relinearization;  // of kFluid
    /// Steps below this, in conditional standard deviations over the root mean square of the residuals, do not spread.
    double substitution_tolerance = 0.05;
    /// Updates between those that let all steps spread. In the others, steps of up to four times the tolerance wait. 1:
    /// none waits.
    int spread_every_updates = 1;
    /// Bytes of R up to which all steps spread in each update: beyond what caches hold, substitution waits for memory.
    std::size_t cached_bytes = std::size_t{8} << 20;
    /// Scalars substituted in a step beyond those of the cliques that it eliminates or corrects. Cliques below wait for
    /// the next steps, with estimates that are a little older. 0: no limit.
    std::int64_t spread_scalars = 0;
    int iterations_per_update = 2;  // Gauss-Newton steps at most, while models are off
    /// Scalars substituted in an update up to which it may take a further step; 0: no limit.
    std::int64_t iterated_scalars = 3000;
    EliminationBudget::Params budget;
    int kept_eliminations = 0;  // see Eliminator, as for the next one
    std::size_t kept_bytes = 0;
  };
  struct Report {
    std::vector<SolverProblem> problems;
    std::int64_t eliminated_scalars = 0, substituted_scalars = 0;
    double flops = 0;  // counted work, see EliminationBudget
    int relinearized_variables = 0, relinearized_factors = 0, corrected_factors = 0;
    int deferred_variables = 0;  // whose relinearization the budget put off
    double largest_change = 0;   // of any x, m or rad
    /// Number of factors that the budget put off, and a bound of what they can take off chi2: their own.
    int waiting_factors = 0;
    double waiting_chi2 = 0;
    std::int64_t waiting_scalars = 0;  // whose substitution was put off
    bool models_off = false;           // some are to be corrected in the next update

    /// True when a further update would find next to nothing to do.
    bool settled() const {
      return waiting_factors == 0 && waiting_scalars == 0 && !models_off && relinearized_factors == 0;
    }
  };

  explicit IncrementalSolver(const Params& params) : params_(params) {}
  IncrementalSolver(const IncrementalSolver&) = delete;  // its parts refer to each other
  IncrementalSolver& operator=(const IncrementalSolver&) = delete;

  VariableId addVariable(const Value& initial);
  /// Provisional factors are removed before the next update corrects models, so it does not matter whether theirs are
  /// off.
  enum class Lifetime : char { kLasting, kProvisional };
  /// Adds a factor; empty when it cannot be used, and then the next report says why.
  std::optional<FactorId> addFactor(AnyFactor factor, Lifetime lifetime = Lifetime::kLasting);
  void removeFactor(FactorId id);
  /// Time at which models found to be off are corrected: in this update, or in the next one. Where factors are about to
  /// be replaced, their correction now would be lost.
  enum class Correction { kNow, kLater };
  /// Lets no step wait in the next update, the last of a drive.
  void spreadAllNext() { spread_all_next_ = true; }
  /// Updates the solution. The report lasts until the next change of the solver.
  const Report& update(Correction correction = Correction::kNow);

  /// Marginalizes variables: their information stays as a factor on their neighbors, and the solution does not change.
  void retire(std::span<const VariableId> variables);
  /// Removes variables and all measurements of them.
  const Report& drop(std::span<const VariableId> variables);
  /// Relinearizes everything until no x changes by more than `tolerance`.
  const Report& converge(int max_iterations, double tolerance);

  Value estimate(VariableId v) const { return graph_.states().estimate(v); }
  SE3 pose(VariableId v) const { return std::get<SE3>(estimate(v)); }
  /// Joint covariance of the stacked right perturbations of the variables, and of J times them. Empty when the system
  /// is singular there. See motorcade::jointCovariance.
  std::optional<Eigen::MatrixXd> jointCovariance(std::span<const VariableId> variables) const;
  std::optional<Eigen::MatrixXd> jointCovariance(std::span<const VariableId> variables,
                                                 const Eigen::Ref<const Eigen::MatrixXd>& J) const;

  /// Counts of the work so far. `relinearizations` are updates that relinearized anything; `reorderings` and
  /// `batch_solves` concern the whole system.
  SolverCounters counters() const;
  const FactorGraph& graph() const { return graph_; }
  const EliminationTree& tree() const { return tree_; }
  std::size_t heldBytes() const { return graph_.models().heldBytes() + eliminator_.heldBytes(); }

 private:
  /// Changes of the graph that the tree does not hold yet.
  struct Changes {
    std::vector<VariableId> touched = {};  // by factors that came or went
    std::vector<VariableId> variables = {};
    std::vector<FactorId> factors = {};

    bool empty() const { return touched.empty() && variables.empty() && factors.empty(); }
    void clear() { touched.clear(), variables.clear(), factors.clear(); }
  };
  /// Work and results of a step.
  struct Step {
    FluidRelinearization::Corrections corrections;
    BackSubstitution::Result solved;
    double spread_sigmas = 0;  // smaller steps of a variable did not spread
    bool of_all = false;       // the whole system was reordered and solved
  };

  void beginReport();
  void endReport();
  /// Enters a step into the report, the only place that does.
  void note(const Step& step);
  /// Takes one Gauss-Newton step: folds in what is new, corrects the models that are off, solves for x, and lets the
  /// estimates follow.
  Step step(const Changes& changes, Correction correction);
  /// Relinearizes and reorders everything.
  Step batchStep(std::span<const VariableId> touched);
  /// True when a step that the budget kept from new Jacobians went farther than its linear models hold.
  bool overshot() const;
  /// Takes such a step anew, from where the Jacobians hold, with new ones of everything.
  void retakeStep();
  void rebuildTop(const Changes& changes);
  BackSubstitution::Spread spreadOfUpdate() const;
  BackSubstitution::Result substitute(double spread_sigmas, std::int64_t most_scalars,
                                      BackSubstitution::Spread spread = BackSubstitution::Spread::kAll);

  Params params_;
  FactorGraph graph_;
  EliminationTree tree_;
  Eliminator eliminator_{graph_, tree_, params_.kept_eliminations, params_.kept_bytes};
  AffectedOrder reordered_{graph_, tree_};
  CliqueWork work_{tree_};
  EliminationBudget budget_{params_.budget};
  FluidRelinearization relinearization_{params_.relinearization, graph_, tree_, substitution_, work_, budget_};
  WaitingFactors waiting_{graph_, tree_, eliminator_, budget_};
  BackSubstitution substitution_{graph_, tree_, work_, budget_};
  Retirement retirement_{graph_, tree_, eliminator_};
  ProblemReporter problems_;
  Report report_;
  SolverCounters counters_;
  double spread_sigmas_ = 0;                                          // of the newest step
  BackSubstitution::Spread spread_ = BackSubstitution::Spread::kAll;  // of the update at hand
  bool spread_all_next_ = false;
  bool retaken_in_vain_ = false;    // the last overshooting step: its models hold no farther
  bool corrections_first_ = false;  // in the update at hand: factors that wait come no nearer
  Changes changes_;                 // since the last update, as well as the factors that were left out
  std::vector<SolverProblem> refused_;
  std::vector<VariableId> near_root_;  // scratch: variables that an order puts there
};

}  // namespace motorcade
