#include "backend/solver/incremental_solver.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "backend/graph/sort_unique.hpp"
#include "backend/solver/joint_covariance.hpp"

namespace motorcade {
namespace {

/// Most new variables of an update that keep the order. At the end of the old order, more of them might all be
/// neighbors of one variable that is eliminated before them, at the cost of a dense system.
constexpr std::size_t kMostAppended = 200;

/// Scalars that wait for substitution beyond which factors that wait may not take much of a budget.
constexpr std::int64_t kBehind = 600;
/// Mismatch of a linear model after a step, in standard deviations, at which the step was too long for it. Models that
/// are about to be relinearized are off by some standard deviations, those of new objects by some tens.
constexpr double kOvershot_sigmas = 100;
constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max();

/// Problem of a factor over these variables, which is left out.
SolverProblem refusal(SolverProblem::Kind kind, VariableId because_of, std::span<const VariableId> variables) {
  SolverProblem problem{.kind = kind, .variable = because_of};
  std::ranges::copy_if(variables, std::back_inserter(problem.others), [&](VariableId v) { return v != because_of; });
  return problem;
}

std::optional<SolverProblem> whyUnusable(const FactorGraph& graph, std::span<const VariableId> variables) {
  for (const VariableId v : variables) {
    if (!graph.contains(v)) return refusal(SolverProblem::Kind::kUnknownVariable, v, variables);
    if (std::ranges::count(variables, v) > 1) return refusal(SolverProblem::Kind::kRepeatedVariable, v, variables);
  }
  return std::nullopt;
}

void touchVariablesOf(const FactorGraph& graph, std::span<const FactorId> factors, std::vector<VariableId>& touched) {
  for (const FactorId f : factors)
    touched.insert(touched.end(), graph.variablesOf(f).begin(), graph.variablesOf(f).end());
  sortUnique(touched);
}

}  // namespace

VariableId IncrementalSolver::addVariable(const Value& initial) {
  const VariableId v = graph_.addVariable(initial);
  problems_.forget(v);
  changes_.variables.push_back(v);
  return v;
}

std::optional<FactorId> IncrementalSolver::addFactor(AnyFactor factor, Lifetime lifetime) {
  const auto named = std::visit([](const auto& any) { return any->variables(); }, factor);
  if (auto problem = whyUnusable(graph_, named)) {
    refused_.push_back(std::move(*problem));
    return std::nullopt;
  }
  const std::vector<VariableId> variables(named.begin(), named.end());
  const auto id = graph_.addFactor(std::move(factor));
  if (!id) {
    refused_.push_back(refusal(SolverProblem::Kind::kNotFinite, variables.front(), variables));
    return std::nullopt;
  }
  if (lifetime == Lifetime::kProvisional) graph_.models().markProvisional(*id);
  changes_.factors.push_back(*id);
  return id;
}

void IncrementalSolver::removeFactor(FactorId id) {
  const auto variables = graph_.variablesOf(id);
  if (std::erase(changes_.factors, id) == 0 && !waiting_.remove(id)) {
    changes_.touched.insert(changes_.touched.end(), variables.begin(), variables.end());
    tree_.removeFactor(tree_.ownerOf(variables), id);
  }
  graph_.removeFactor(id);
}

void IncrementalSolver::beginReport() {
  report_ = {.problems = std::move(refused_), .eliminated_scalars = -eliminator_.eliminatedScalars()};
  refused_.clear();
  eliminator_.resetWeakestPivot();
  const bool behind = relinearization_.anyModelOff() || substitution_.waitingScalars() > kBehind;
  budget_.beginUpdate(relinearization_.correctionsWait() || (behind && !waiting_.factors().empty()));
}

void IncrementalSolver::note(const Step& step) {
  report_.relinearized_variables += step.corrections.relinearized_variables;
  report_.relinearized_factors += step.corrections.relinearized_factors;
  report_.corrected_factors += step.corrections.corrected_factors;
  report_.substituted_scalars += step.solved.scalars;
  report_.largest_change = std::max(report_.largest_change, step.solved.largest_change);
  if (step.of_all) ++counters_.reorderings, ++counters_.batch_solves;
  spread_sigmas_ = step.spread_sigmas;
}

void IncrementalSolver::endReport() {
  report_.eliminated_scalars += eliminator_.eliminatedScalars();
  report_.flops = budget_.doneFlops();
  budget_.endUpdate();
  report_.deferred_variables = static_cast<int>(relinearization_.deferred());
  report_.waiting_factors = static_cast<int>(waiting_.factors().size());
  report_.waiting_chi2 = waiting_.chi2();
  report_.waiting_scalars = substitution_.waitingScalars();
  report_.models_off = relinearization_.anyModelOff();
  if (report_.relinearized_factors > 0) ++counters_.relinearizations;
  problems_.append(graph_, tree_, eliminator_.weakestPivot(), report_.problems);
  changes_.clear();
}

const IncrementalSolver::Report& IncrementalSolver::update(Correction correction) {
  beginReport();
  ++counters_.updates;
  spread_ = spreadOfUpdate();
  corrections_first_ = budget_.limitsFlops() && relinearization_.correctionsWait() && !corrections_first_;
  spread_all_next_ = false;
  const bool fluid = params_.policy == Policy::kFluid;
  const bool batch_due =
      counters_.updates % params_.batch_every_updates == 0 || changes_.variables.size() > kMostAppended;
  if (fluid) waiting_.admit(changes_.factors, changes_.touched, corrections_first_);
  touchVariablesOf(graph_, changes_.factors, changes_.touched);
  note(!fluid && batch_due ? batchStep(changes_.touched) : step(changes_, correction));
  if (!overshot())
    retaken_in_vain_ = false;
  else if (!retaken_in_vain_)
    retakeStep();
  const int steps = correction == Correction::kNow ? params_.iterations_per_update : 1;
  const auto costsLittle = [&] {
    return params_.iterated_scalars == 0 || report_.substituted_scalars <= params_.iterated_scalars;
  };
  for (int i = 1; i < steps && relinearization_.anyModelOff() && costsLittle() && !budget_.isOverForEliminations(); ++i)
    note(step({}, correction));
  endReport();
  return report_;
}

/// All steps spread in every few updates, in those without changes, and always while R is small.
BackSubstitution::Spread IncrementalSolver::spreadOfUpdate() const {
  const bool all = spread_all_next_ || changes_.empty() || counters_.updates % params_.spread_every_updates == 0 ||
                   eliminator_.factorBytes() <= params_.cached_bytes;
  return all ? BackSubstitution::Spread::kAll : BackSubstitution::Spread::kFar;
}

IncrementalSolver::Step IncrementalSolver::step(const Changes& changes, Correction correction) {
  Step step;
  work_.begin();
  for (const VariableId v : changes.touched) work_.markRemoved(tree_.cliqueOf(v));
  if (params_.policy == Policy::kFluid) relinearization_.beginStep(changes.factors, waiting_.factors());
  if (params_.policy == Policy::kFluid && correction == Correction::kNow)
    step.corrections = relinearization_.correctModels(corrections_first_);
  const double before = eliminator_.flops();
  work_.apply(eliminator_);
  rebuildTop(changes);
  budget_.finishPlanned(eliminator_.flops() - before);
  step.spread_sigmas = params_.substitution_tolerance * graph_.models().rmsResidual();
  step.solved = substitute(step.spread_sigmas, params_.spread_scalars > 0 ? params_.spread_scalars : kNoLimit, spread_);
  return step;
}

/// Eliminates the marked cliques' variables and the new ones, in a new order.
void IncrementalSolver::rebuildTop(const Changes& changes) {
  auto& [variables, factors, orphans] = eliminator_.remove(work_.releaseRemoved());
  variables.insert(variables.end(), changes.variables.begin(), changes.variables.end());
  factors.insert(factors.end(), changes.factors.begin(), changes.factors.end());
  if (variables.empty()) return;
  near_root_ = changes.touched;
  for (const FactorId f : waiting_.factors())  // so that lifted variables stay where they are
    near_root_.insert(near_root_.end(), graph_.variablesOf(f).begin(), graph_.variablesOf(f).end());
  const bool reorder = params_.policy == Policy::kFluid;
  const auto order = reorder ? reordered_(variables, factors, orphans, near_root_, changes.variables)
                             : std::span<const VariableId>(variables);
  work_.markNew(eliminator_.eliminate({.order = order, .factors = factors, .orphans = orphans}));
}

/// Solves for x where anything changed, and finds the models that are off there.
BackSubstitution::Result IncrementalSolver::substitute(double spread_sigmas, std::int64_t most_scalars,
                                                       BackSubstitution::Spread spread) {
  const auto solved = substitution_(spread_sigmas, std::min(most_scalars, budget_.substitutionsLeft()), spread);
  budget_.spendSubstitutions(solved.scalars);
  if (params_.policy == Policy::kFluid) relinearization_.compareModels(solved);
  return solved;
}

IncrementalSolver::Step IncrementalSolver::batchStep(std::span<const VariableId> touched) {
  const std::vector<VariableId> variables = graph_.variables();
  const std::vector<FactorId> factors = graph_.factors();
  work_.begin();
  relinearization_.clear();
  waiting_.clear();
  budget_.lift();
  eliminator_.remove(tree_.cliques());
  for (const VariableId v : variables) graph_.states().restartCoordinates(v);
  for (const FactorId f : factors) graph_.models().linearize(f);
  if (variables.empty()) return {};
  work_.markNew(eliminator_.eliminate({.order = reordered_(variables, factors, {}, touched), .factors = factors}));
  return {.corrections = {.relinearized_factors = static_cast<int>(factors.size())},
          .solved = substitute(0, kNoLimit),
          .of_all = true};
}

bool IncrementalSolver::overshot() const {
  // A budget of work or time alone is a promise of how long an update takes.
  return params_.policy == Policy::kFluid && params_.budget.scalars > 0 &&
         relinearization_.worstMismatch() > kOvershot_sigmas;
}

/// Jacobians of one region that were taken at different estimates do not agree on what a common motion of the region
/// leaves as it is. Where little else holds the region, as after a gap, a step may run away along that motion.
void IncrementalSolver::retakeStep() {
  for (const VariableId v : graph_.variables()) graph_.states().returnToLinearizationPoint(v);
  note(batchStep(changes_.touched));
  retaken_in_vain_ = overshot();
}

const IncrementalSolver::Report& IncrementalSolver::converge(int max_iterations, double tolerance) {
  beginReport();
  touchVariablesOf(graph_, changes_.factors, changes_.touched);
  for (int i = 0; i < max_iterations; ++i) {
    report_.largest_change = 0;
    note(batchStep(changes_.touched));
    if (report_.largest_change < tolerance) break;
  }
  endReport();
  return report_;
}

void IncrementalSolver::retire(std::span<const VariableId> variables) {
  assert(changes_.empty());
  // Waiting factors whose variables leave can wait no longer.
  if (Changes late{.factors = waiting_.takeWith(variables)}; !late.factors.empty()) {
    for (const FactorId f : late.factors) graph_.models().linearize(f);
    touchVariablesOf(graph_, late.factors, late.touched);
    note(step(late, Correction::kNow));
  }
  retirement_.marginalize(variables);
  counters_.retired_variables += static_cast<std::int64_t>(variables.size());
}

const IncrementalSolver::Report& IncrementalSolver::drop(std::span<const VariableId> variables) {
  assert(changes_.empty());
  beginReport();
  waiting_.takeWith(variables);  // they leave with the variables
  work_.begin();
  work_.markNew(retirement_.drop(variables));
  note({.corrections = {}, .solved = substitute(spread_sigmas_, kNoLimit), .spread_sigmas = spread_sigmas_});
  endReport();
  return report_;
}

std::optional<Eigen::MatrixXd> IncrementalSolver::jointCovariance(std::span<const VariableId> variables) const {
  Eigen::Index scalars = 0;
  for (const VariableId v : variables) scalars += graph_.sizeOf(v);
  return jointCovariance(variables, Eigen::MatrixXd::Identity(scalars, scalars));
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
