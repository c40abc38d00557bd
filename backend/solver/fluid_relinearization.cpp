#include <algorithm>
#include <cmath>

#include "backend/solver/incremental_solver.hpp"

/// Fluid relinearization: which linear models are off after a step, and what the next step does about it.
namespace motorcade {
namespace {

constexpr double kComparedShare = 0.25;  // of the tolerance: below it a variable's factors need no look
constexpr double kLeisurelyShare = 0.2;  // of the turn at which relinearization is urgent
constexpr double kDriftedShare =
    1.0001;  // of the same: a Jacobian that drifted is urgent however little its variables turned
constexpr double kTurnedWithShare =
    0.1;  // of the worst variable's turn: those that turned more are relinearized with it
constexpr std::size_t kWorstAtOnce = 16, kLargestRegion = 1000;

}  // namespace

/// Root mean square over the factors of their residuals' norms, in standard deviations: the scale of all tolerances.
double IncrementalSolver::rmsResidual() const { return std::sqrt(std::max(graph_.meanSquareResidual(), 1e-8)); }

/// Finds the models that are off after the step.
void IncrementalSolver::compareModels() {
  checked_in_step_.resize(graph_.factorSlots(), 0);
  const double tolerance = params_.mismatch_tolerance * rmsResidual();
  for (const VariableId v : moved_) {
    if (const double turn = graph_.turnSinceLinearization(v); turn > kLeisurelyShare * params_.relinearize_rad)
      markStale(v, turn);
    if (graph_.mismatchBound(v) < kComparedShare * tolerance) continue;
    graph_.markCompared(v);
    for (const FactorId f : graph_[v].factors) {
      if (checked_in_step_[f.value] == step_) continue;
      checked_in_step_[f.value] = step_;
      const double norm = graph_.mismatch(f).norm;
      if (norm > tolerance) off_.push_back({f, norm});
    }
  }
}

/// The variable's factors want new Jacobians; `turn_rad` says how urgently.
void IncrementalSolver::markStale(VariableId v, double turn_rad) {
  staleness_.resize(graph_.slots(), 0.0);
  double& staleness = staleness_[v.value];
  if (staleness == 0) stale_.push_back(v);
  staleness = std::max(staleness, std::max(turn_rad, 1e-12));
}

/// Puts the models right that are off: by new Jacobians where they drifted and the budget allows, by new right-hand
/// sides elsewhere.
void IncrementalSolver::correctModels() {
  // A new factor may have taken the id of one that left.
  std::erase_if(off_, [&](const OffModel& off) { return !graph_.contains(off.factor) || isNew(off.factor); });
  for (const OffModel& off : off_)
    if (graph_.drift(off.factor) + off.mismatch > params_.jacobian_drift_sigmas)
      for (const VariableId v : graph_.factor(off.factor).variables())
        markStale(v, std::max(kDriftedShare * params_.relinearize_rad, graph_.turnSinceLinearization(v)));
  relinearized_.clear();
  relinearizeStale();
  for (const FactorId f : relinearized_) graph_.linearize(f);
  report_.relinearized_factors += static_cast<int>(relinearized_.size());
  for (const OffModel& off : off_)
    if (relinearized_in_step_[off.factor.value] != step_) shiftResidual(off.factor);
  off_.clear();
}

/// First what costs nothing, as its cliques are eliminated anew in any case; then the worst, as far as the allowances
/// reach: one for those so far off that the solution suffers, one for the others, which can wait. The budget bounds
/// both; what an update leaves of it is saved while the worst variable costs more.
void IncrementalSolver::relinearizeStale() {
  relinearized_in_step_.resize(graph_.factorSlots(), 0);
  for (const int c : removed_cliques_)
    for (const VariableId v : tree_[c].frontalVariables())
      if (isStale(v) && workOfRelinearizing(v).scalars == 0) relinearize(v);
  std::erase_if(stale_, [&](VariableId v) {
    if (!graph_.contains(v)) staleness_[v.value] = 0;  // its id may be given out again
    return !isStale(v);
  });
  const auto worse = [&](VariableId a, VariableId b) {
    const double turn_a = staleness_[a.value], turn_b = staleness_[b.value];
    return turn_a > turn_b || (turn_a == turn_b && a < b);
  };
  double urgent_flops = params_.urgent_flops, polish_flops = params_.polish_flops;
  auto reach = Reach::kWithin;
  for (std::size_t done = 0; done < stale_.size() && reach == Reach::kWithin;) {
    const auto from = stale_.begin() + static_cast<std::ptrdiff_t>(done);
    const std::size_t end = std::min(done + kWorstAtOnce, stale_.size());
    std::partial_sort(from, stale_.begin() + static_cast<std::ptrdiff_t>(end), stale_.end(), worse);
    for (; done < end && reach != Reach::kBeyondBudget; ++done) {
      const VariableId v = stale_[done];
      if (!isStale(v)) continue;  // twice in the list, or of the region of one before it
      double& flops_left = staleness_[v.value] > params_.relinearize_rad ? urgent_flops : polish_flops;
      reach = std::max(reach, relinearizeRegion(v, flops_left));
    }
  }
  std::erase_if(stale_, [&](VariableId v) { return !isStale(v); });
  saved_scalars_ = reach == Reach::kBeyondBudget ? budget_left_ : 0;
}

/// The variable and, as new Jacobians of a part of a stiff region bias the rest of it, the connected ones that turned
/// with it.
IncrementalSolver::Reach IncrementalSolver::relinearizeRegion(VariableId worst, double& flops_left) {
  const double turn_rad = kTurnedWithShare * staleness_[worst.value];
  if (const Reach reach = relinearizeWithin(worst, flops_left); reach != Reach::kWithin) return reach;
  region_.assign(1, worst);
  ++region_mark_;
  in_region_.resize(graph_.slots(), 0);
  in_region_[worst.value] = region_mark_;
  for (std::size_t i = 0; i < region_.size() && i < kLargestRegion; ++i)
    for (const FactorId f : graph_[region_[i]].factors)
      for (const VariableId v : graph_.factor(f).variables()) {
        if (in_region_[v.value] == region_mark_ || graph_.turnSinceLinearization(v) <= turn_rad) continue;
        in_region_[v.value] = region_mark_;
        if (relinearizeWithin(v, flops_left) == Reach::kWithin) region_.push_back(v);
      }
  return Reach::kWithin;
}

IncrementalSolver::Reach IncrementalSolver::relinearizeWithin(VariableId v, double& flops_left) {
  const EliminationWork work = workOfRelinearizing(v);
  if (work.scalars > budget_left_) return Reach::kBeyondBudget;
  if (work.flops > flops_left) return Reach::kBeyondAllowance;
  budget_left_ -= work.scalars;
  flops_left -= work.flops;
  relinearize(v);
  return Reach::kWithin;
}

bool IncrementalSolver::isStale(VariableId v) const {
  return static_cast<std::size_t>(v.value) < staleness_.size() && staleness_[v.value] > 0;
}

/// What is eliminated anew for it beyond what is in any case.
IncrementalSolver::EliminationWork IncrementalSolver::workOfRelinearizing(VariableId v) {
  counted_.resize(tree_.slots(), 0);
  ++count_mark_;
  EliminationWork work;
  for (const FactorId f : graph_[v].factors) {
    if (isNew(f)) continue;
    for (int c = tree_.ownerOf(graph_.factor(f)); c >= 0 && work_[c] < Work::kRefresh && counted_[c] != count_mark_;
         c = tree_[c].parent) {
      counted_[c] = count_mark_;
      work.scalars += tree_[c].frontal_size;
      work.flops += static_cast<double>(tree_[c].frontal_size) * tree_[c].size * tree_[c].size;
    }
  }
  return work;
}

/// Its factors get their Jacobians when the points of all variables have moved.
void IncrementalSolver::relinearize(VariableId v) {
  graph_.moveLinearizationPoint(v);
  if (isStale(v)) staleness_[v.value] = 0;
  ++report_.relinearized_variables;
  for (const FactorId f : graph_[v].factors) {
    if (relinearized_in_step_[f.value] == step_) continue;
    relinearized_in_step_[f.value] = step_;
    relinearized_.push_back(f);
    if (!isNew(f)) markWork(tree_.ownerOf(graph_.factor(f)), Work::kRefresh);
  }
}

/// Not in the tree yet.
bool IncrementalSolver::isNew(FactorId f) const { return std::ranges::find(new_factors_, f) != new_factors_.end(); }

/// The model's new residual changes the right-hand side of its clique by J^T r.
void IncrementalSolver::shiftResidual(FactorId id) {
  const auto mismatch = graph_.mismatch(id);
  graph_.correctResidual(id, mismatch.r);
  graph_.addDrift(id, mismatch.norm);
  ++report_.corrected_factors;
  const Factor& factor = graph_.factor(id);
  const int owner = tree_.ownerOf(factor);
  markWork(owner, Work::kShift);
  if (work_[owner] != Work::kShift) return;  // is eliminated anew
  const auto J = graph_.term(id);
  const bool gradient = factor.form() == Factor::Form::kInformation;
  const Eigen::Map<const Eigen::VectorXd> r(mismatch.r.data(), static_cast<Eigen::Index>(mismatch.r.size()));
  double* change = changes_.data() + change_begin_[owner];
  int column = 0;
  for (const VariableId v : factor.variables()) {
    int row = 0;
    for (const VariableId u : tree_[owner].variables) {
      if (u == v) break;
      row += graph_.sizeOf(u);
    }
    for (int i = 0; i < graph_.sizeOf(v); ++i, ++column) change[row + i] += gradient ? r[column] : J.col(column).dot(r);
  }
}

}  // namespace motorcade
