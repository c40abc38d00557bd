#include "backend/solver/incremental_solver.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <limits>

#include "backend/graph/sort_unique.hpp"
#include "backend/solver/joint_covariance.hpp"

namespace motorcade {
namespace {

/// So many new variables in one update have no order that could be kept: at the end of the old one they may all be
/// neighbors of one that is eliminated before them, at the cost of a dense system.
constexpr std::size_t kMostAppended = 200;

constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max();

/// A factor over these variables was left out.
SolverProblem refusal(SolverProblem::Kind kind, VariableId because_of, std::span<const VariableId> variables) {
  SolverProblem problem{.kind = kind, .variable = because_of};
  std::ranges::copy_if(variables, std::back_inserter(problem.others), [&](VariableId v) { return v != because_of; });
  return problem;
}

}  // namespace

VariableId IncrementalSolver::addVariable(const Value& initial) {
  const VariableId v = graph_.addVariable(initial);
  problems_.forget(v);
  new_variables_.push_back(v);
  return v;
}

bool IncrementalSolver::usable(std::span<const VariableId> variables) {
  for (const VariableId v : variables) {
    if (!graph_.contains(v))
      refused_.push_back(refusal(SolverProblem::Kind::kUnknownVariable, v, variables));
    else if (std::ranges::count(variables, v) > 1)
      refused_.push_back(refusal(SolverProblem::Kind::kRepeatedVariable, v, variables));
    else
      continue;
    return false;
  }
  return true;
}

std::optional<FactorId> IncrementalSolver::addFactor(AnyFactor factor, Lifetime lifetime) {
  const auto variables = std::visit([](const auto& any) { return any->variables(); }, factor);
  if (!usable(variables)) return std::nullopt;
  last_.assign(variables.begin(), variables.end());
  const auto id = graph_.addFactor(std::move(factor));
  if (!id) {
    refused_.push_back(refusal(SolverProblem::Kind::kNotFinite, last_.front(), last_));
    return std::nullopt;
  }
  if (lifetime == Lifetime::kProvisional) graph_.models().markProvisional(*id);
  new_factors_.push_back(*id);
  return id;
}

void IncrementalSolver::removeFactor(FactorId id) {
  const auto variables = graph_.variablesOf(id);
  if (std::erase(new_factors_, id) == 0 && !waiting_.remove(id)) {
    touched_.insert(touched_.end(), variables.begin(), variables.end());
    tree_.removeFactor(tree_.ownerOf(graph_.variablesOf(id)), id);
  }
  graph_.removeFactor(id);
}

void IncrementalSolver::beginReport() {
  report_.problems.clear();
  report_.problems.swap(refused_);
  report_.moved.clear();
  report_.eliminated_scalars = -eliminator_.eliminatedScalars();
  report_.substituted_scalars = 0;
  report_.relinearized_variables = report_.relinearized_factors = report_.corrected_factors =
      report_.deferred_variables = 0;
  report_.largest_change = 0;
  eliminator_.resetWeakestPivot();
  budget_.beginUpdate();
}

void IncrementalSolver::endReport() {
  report_.eliminated_scalars += eliminator_.eliminatedScalars();
  report_.deferred_variables = static_cast<int>(relinearization_.deferred());
  report_.waiting_factors = static_cast<int>(waiting_.factors().size());
  report_.waiting_chi2 = waiting_.chi2();
  report_.waiting_scalars = substitution_.waitingScalars();
  if (report_.relinearized_factors > 0) ++counters_.relinearizations;
  sortUnique(report_.moved);
  problems_.append(graph_, tree_, eliminator_.weakestPivot(), report_.problems);
  touched_.clear();
  new_variables_.clear();
  new_factors_.clear();
}

const IncrementalSolver::Report& IncrementalSolver::update(Correction correction) {
  beginReport();
  ++counters_.updates;
  const bool batch_due = counters_.updates % params_.batch_every_updates == 0 || new_variables_.size() > kMostAppended;
  if (params_.policy == Policy::kEveryN && batch_due) {
    batchStep();
  } else {
    if (params_.policy == Policy::kFluid) notingPace([&] { waiting_.admit(new_factors_, touched_); });
    step(true, correction);
    new_factors_.clear();
    const int steps = correction == Correction::kNow ? params_.iterations_per_update : 1;
    for (int i = 1; i < steps && mayIterate(); ++i) step(false, correction);
  }
  endReport();
  return report_;
}

/// Models are off, and the update has not cost too much yet for another step.
bool IncrementalSolver::mayIterate() const {
  return relinearization_.anyModelOff() &&
         (params_.iterated_scalars == 0 || report_.substituted_scalars <= params_.iterated_scalars);
}

/// One Gauss-Newton step: folds in what is new, corrects the models that are off, solves for x, and lets the estimates
/// follow.
void IncrementalSolver::step(bool fold, Correction correction) {
  work_.begin();
  if (fold) {
    touchNewFactors();
    for (const VariableId v : touched_) work_.markRemoved(tree_.cliqueOf(v));
  }
  if (params_.policy == Policy::kFluid) relinearization_.beginStep(new_factors_, waiting_.factors());
  if (params_.policy == Policy::kFluid && correction == Correction::kNow) {
    const auto corrections = relinearization_.correctModels();
    report_.relinearized_variables += corrections.relinearized_variables;
    report_.relinearized_factors += corrections.relinearized_factors;
    report_.corrected_factors += corrections.corrected_factors;
  }
  notingPace([&] {
    work_.apply(eliminator_);
    if (fold) rebuildTop();
  });
  spread_sigmas_ = params_.substitution_tolerance * graph_.models().rmsResidual();
  substitute(params_.spread_scalars > 0 ? params_.spread_scalars : kNoLimit);
}

template <class Elimination>
void IncrementalSolver::notingPace(const Elimination& eliminate) {
  const auto begin = std::chrono::steady_clock::now();
  const std::int64_t before = eliminator_.eliminatedScalars();
  eliminate();
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
  budget_.notePace(eliminator_.eliminatedScalars() - before, took.count());
}

void IncrementalSolver::touchNewFactors() {
  for (const FactorId f : new_factors_) {
    const auto variables = graph_.variablesOf(f);
    touched_.insert(touched_.end(), variables.begin(), variables.end());
  }
  sortUnique(touched_);
}

/// Eliminates the marked cliques' variables and the new ones, in a new order.
void IncrementalSolver::rebuildTop() {
  auto& [variables, factors, orphans] = eliminator_.remove(work_.releaseRemoved());
  variables.insert(variables.end(), new_variables_.begin(), new_variables_.end());
  factors.insert(factors.end(), new_factors_.begin(), new_factors_.end());
  if (variables.empty()) return;
  const bool reorder = params_.policy == Policy::kFluid;
  last_ = touched_;
  for (const FactorId f : waiting_.factors())  // so that lifted variables stay where they are
    last_.insert(last_.end(), graph_.variablesOf(f).begin(), graph_.variablesOf(f).end());
  const auto order =
      reorder ? reordered_(variables, factors, orphans, last_, new_variables_) : std::span<const VariableId>(variables);
  work_.markNew(eliminator_.eliminate({.order = order, .factors = factors, .orphans = orphans}));
}

/// Solves for x where anything changed, and finds the models that are off there.
void IncrementalSolver::substitute(std::int64_t most_scalars) {
  const auto solved = substitution_(spread_sigmas_, std::min(most_scalars, budget_.substitutionsLeft()));
  budget_.spendSubstitutions(solved.scalars);
  report_.moved.insert(report_.moved.end(), solved.moved.begin(), solved.moved.end());
  report_.substituted_scalars += solved.scalars;
  report_.largest_change = std::max(report_.largest_change, solved.largest_change);
  if (params_.policy == Policy::kFluid) relinearization_.compareModels(solved);
}

/// Relinearizes and reorders everything.
void IncrementalSolver::batchStep() {
  work_.begin();
  report_.relinearized_factors += static_cast<int>(graph_.factorCount());
  relinearization_.clear();
  waiting_.clear();
  touchNewFactors();
  budget_.lift();
  eliminator_.remove(tree_.cliques());
  const std::vector<VariableId> variables = graph_.variables();
  const std::vector<FactorId> factors = graph_.factors();
  for (const VariableId v : variables) graph_.states().restartCoordinates(v);
  for (const FactorId f : factors) graph_.models().linearize(f);
  if (variables.empty()) return;
  work_.markNew(eliminator_.eliminate({.order = reordered_(variables, factors, {}, touched_), .factors = factors}));
  ++counters_.reorderings, ++counters_.batch_solves;
  spread_sigmas_ = 0;
  substitute(kNoLimit);
}

const IncrementalSolver::Report& IncrementalSolver::converge(int max_iterations, double tolerance) {
  beginReport();
  for (int i = 0; i < max_iterations; ++i) {
    report_.largest_change = 0;
    batchStep();
    if (report_.largest_change < tolerance) break;
  }
  endReport();
  return report_;
}

void IncrementalSolver::retire(std::span<const VariableId> variables) {
  assert(touched_.empty() && new_variables_.empty() && new_factors_.empty());
  takeInFactorsOf(variables);
  retirement_.marginalize(variables);
  counters_.retired_variables += static_cast<std::int64_t>(variables.size());
}

/// Waiting factors whose variables leave can wait no longer.
void IncrementalSolver::takeInFactorsOf(std::span<const VariableId> leaving) {
  new_factors_ = waiting_.takeWith(leaving);
  if (new_factors_.empty()) return;
  for (const FactorId f : new_factors_) graph_.models().linearize(f);
  step(true, Correction::kNow);
  touched_.clear();
  new_factors_.clear();
}

const IncrementalSolver::Report& IncrementalSolver::drop(std::span<const VariableId> variables) {
  assert(touched_.empty() && new_variables_.empty() && new_factors_.empty());
  beginReport();
  waiting_.takeWith(variables);  // they leave with the variables
  work_.begin();
  work_.markNew(retirement_.drop(variables));
  substitute(kNoLimit);
  endReport();
  return report_;
}

std::optional<Eigen::MatrixXd> IncrementalSolver::jointCovariance(std::span<const VariableId> variables) const {
  return motorcade::jointCovariance(graph_, tree_, variables);
}

std::optional<Eigen::MatrixXd> IncrementalSolver::jointCovariance(std::span<const VariableId> variables,
                                                                  const Eigen::Ref<const Eigen::MatrixXd>& J) const {
  return motorcade::jointCovariance(graph_, tree_, variables, J);
}

SolverCounters IncrementalSolver::counters() const {
  SolverCounters counters = counters_;
  counters.variables = static_cast<std::int64_t>(graph_.variableCount());
  counters.factors = static_cast<std::int64_t>(graph_.factorCount());
  counters.chi2 = graph_.models().totalCost();
  return counters;
}

}  // namespace motorcade
