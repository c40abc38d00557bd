#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "backend/elimination_tree.hpp"
#include "backend/factor_graph.hpp"
#include "core/messages.hpp"

namespace motorcade {

/// Incremental square-root smoothing (iSAM, Kaess et al. 2008, on the tree of iSAM2, 2012): keeps R of the linearised problem as a tree of
/// small dense cliques; an update eliminates anew only the cliques from where new factors enter up to the root. Gauss-Newton, one step per
/// update.
///
/// Add variables and factors, then `update`. `retire` and `drop` want no additions waiting.
class IncrementalSolver {
 public:
  enum class Policy {
    kEveryN,  // keeps the order and the linearisation between batch steps, every `batch_every_updates`
    kFluid,   // relinearises what moved past the thresholds and reorders what an update touches
  };
  struct Params {
    Policy policy = Policy::kFluid;
    int batch_every_updates = 50;
    double relinearize_m = 0.05, relinearize_rad = 0.005;  // entries of vectors count as m
    double substitution_threshold = 1e-5;                  // deltas that change by less do not spread; 0 is exact
  };
  struct Report {
    std::vector<SingularScalar> singular;  // held at delta zero
    int eliminated_scalars = 0, relinearized_variables = 0;
    double largest_change = 0;  // of any delta, m or rad
  };

  explicit IncrementalSolver(const Params& params) : params_(params) {}

  VariableId addVariable(const Value& initial);
  /// Empty when the factor is not finite: it is left out.
  std::optional<FactorId> addFactor(std::unique_ptr<const Factor> factor);
  void removeFactor(FactorId id);
  Report update();

  /// Marginalises variables: what they know stays as a factor on their neighbours, and the solution does not change.
  void retire(std::span<const VariableId> variables);
  /// Removes variables with all that was measured of them.
  Report drop(std::span<const VariableId> variables);
  /// Relinearises everything until no delta exceeds `tolerance`.
  Report converge(int max_iterations, double tolerance);

  Value estimate(VariableId v) const { return graph_.estimate(v); }
  SE3 pose(VariableId v) const { return std::get<SE3>(estimate(v)); }
  /// Joint covariance of the variables' deltas, stacked, from R. Empty when the system is singular there.
  std::optional<Eigen::MatrixXd> jointCovariance(std::span<const VariableId> variables) const;

  /// In the counters, `relinearizations` are updates that relinearised anything; `reorderings` and `batch_solves` concern the whole system.
  SolverCounters counters() const;
  const FactorGraph& graph() const { return graph_; }
  const EliminationTree& tree() const { return tree_; }

 private:
  enum class Order { kKeep, kReorder };
  struct RetiringPart;

  std::vector<int> relinearize(std::span<const VariableId> variables);
  std::vector<VariableId> movedVariables() const;
  std::vector<int> withAncestors(std::vector<int> cliques) const;
  std::vector<Contribution> contributionsOf(std::span<const VariableId> variables, std::span<const VariableId> boundary,
                                            std::span<const int> orphans);
  std::vector<VariableId> reordered(std::span<const VariableId> variables, std::span<const Contribution> contributions) const;
  void rebuild(std::vector<VariableId> variables, std::span<const int> orphans, Order order, Report& report);
  void substitute(std::span<const int> new_cliques, Report& report);
  bool solve(const Clique& clique, bool is_new, Report& report);
  void batchStep(Report& report);
  std::vector<RetiringPart> partsWith(std::span<const VariableId> variables) const;
  void retirePart(const RetiringPart& part, std::span<const VariableId> gone);

  Params params_;
  FactorGraph graph_;
  EliminationTree tree_;
  std::vector<VariableId> touched_, new_variables_;
  std::vector<char> marked_;         // scratch, per variable: in the set at hand
  std::vector<char> delta_changed_;  // scratch, per variable
  SolverCounters counters_;
};

}  // namespace motorcade
