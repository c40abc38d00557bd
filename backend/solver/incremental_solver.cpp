#include "backend/solver/incremental_solver.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>

#include "backend/elimination/dense_kernels.hpp"

namespace motorcade {
namespace {

constexpr double kPaceShare = 0.1;  // of the newest update in the mean pace

template <class T>
void sortUnique(std::vector<T>& items) {
  std::ranges::sort(items);
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

/// A factor over these variables was left out.
SolverProblem refusal(SolverProblem::Kind kind, VariableId because_of, std::span<const VariableId> variables) {
  SolverProblem problem{.kind = kind, .variable = because_of};
  std::ranges::copy_if(variables, std::back_inserter(problem.others), [&](VariableId v) { return v != because_of; });
  return problem;
}

}  // namespace

VariableId IncrementalSolver::addVariable(const Value& initial) {
  const VariableId v = graph_.addVariable(initial);
  explanations_.forget(v);
  new_variables_.push_back(v);
  return v;
}

bool IncrementalSolver::usable(const Factor& factor) {
  const auto variables = factor.variables();
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

std::optional<FactorId> IncrementalSolver::addFactor(std::unique_ptr<const Factor> factor) {
  if (!usable(*factor)) return std::nullopt;
  const std::size_t count = touched_.size();
  touched_.insert(touched_.end(), factor->variables().begin(), factor->variables().end());
  const auto id = graph_.addFactor(std::move(factor));
  if (!id) {
    const auto variables = std::span(touched_).subspan(count);
    refused_.push_back(refusal(SolverProblem::Kind::kNotFinite, variables.front(), variables));
    touched_.resize(count);
    return std::nullopt;
  }
  new_factors_.push_back(*id);
  return id;
}

void IncrementalSolver::removeFactor(FactorId id) {
  const auto variables = graph_.factor(id).variables();
  if (std::erase(new_factors_, id) == 0) {
    touched_.insert(touched_.end(), variables.begin(), variables.end());
    tree_.removeFactor(tree_.ownerOf(graph_.factor(id)), id);
  }
  graph_.removeFactor(id);
}

void IncrementalSolver::beginReport() {
  report_.problems.clear();
  report_.problems.swap(refused_);
  report_.moved.clear();
  report_.eliminated_scalars = -tree_.eliminatedScalars();
  report_.substituted_scalars = 0;
  report_.relinearized_variables = report_.relinearized_factors = report_.corrected_factors =
      report_.deferred_variables = 0;
  report_.largest_change = 0;
  tree_.clearFindings();
  budget_left_ = budget();
}

std::int64_t IncrementalSolver::budget() const {
  auto scalars = std::numeric_limits<std::int64_t>::max();
  if (params_.budget_scalars > 0) scalars = params_.budget_scalars + saved_scalars_;
  if (params_.budget_ms > 0 && scalars_per_ms_ > 0)
    scalars = std::min(scalars, static_cast<std::int64_t>(params_.budget_ms * scalars_per_ms_) + saved_scalars_);
  return scalars;
}

void IncrementalSolver::notePace(double update_ms) {
  if (report_.eliminated_scalars == 0 || update_ms <= 0) return;
  const double now = static_cast<double>(report_.eliminated_scalars) / update_ms;
  scalars_per_ms_ = scalars_per_ms_ > 0 ? scalars_per_ms_ + kPaceShare * (now - scalars_per_ms_) : now;
}

void IncrementalSolver::endReport() {
  report_.eliminated_scalars += tree_.eliminatedScalars();
  report_.deferred_variables = static_cast<int>(stale_.size());
  if (report_.relinearized_factors > 0) ++counters_.relinearizations;
  sortUnique(report_.moved);
  explanations_.append(graph_, tree_, report_.problems);
  touched_.clear();
  new_variables_.clear();
  new_factors_.clear();
}

const IncrementalSolver::Report& IncrementalSolver::update() {
  const auto begin = std::chrono::steady_clock::now();
  beginReport();
  ++counters_.updates;
  if (params_.policy == Policy::kEveryN && counters_.updates % params_.batch_every_updates == 0) {
    batchStep();
  } else {
    step(true);
    new_factors_.clear();
    for (int i = 1; i < params_.iterations_per_update && mayIterate(); ++i) step(false);
  }
  endReport();
  if (params_.budget_ms > 0)
    notePace(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  return report_;
}

/// Models are off, and the update has not cost too much yet for another step.
bool IncrementalSolver::mayIterate() const {
  return !off_.empty() && (params_.iterated_scalars == 0 || report_.substituted_scalars <= params_.iterated_scalars);
}

/// One Gauss-Newton step: folds in what is new, corrects the models that are off, solves for x, and lets the estimates
/// follow.
void IncrementalSolver::step(bool fold) {
  ++step_;
  work_.resize(tree_.slots(), Work::kNone);
  change_begin_.resize(tree_.slots());
  dirty_.clear();
  changes_.clear();
  removed_cliques_.clear();
  created_.clear();
  if (fold) markTouched();
  if (params_.policy == Policy::kFluid) correctModels();
  workThroughDirtyCliques();
  if (fold) rebuildTop();
  spread_sigmas_ = params_.substitution_tolerance * rmsResidual();
  substitute();
  if (params_.policy == Policy::kFluid) compareModels();
}

/// Marks a clique and all above it.
void IncrementalSolver::markWork(int clique, Work work) {
  for (int c = clique; c >= 0 && work_[c] < work; c = tree_[c].parent) {
    if (work_[c] == Work::kNone) {
      dirty_.push_back(c);
      change_begin_[c] = changes_.size();
      if (work == Work::kShift) changes_.resize(changes_.size() + tree_[c].size, 0.0);
    }
    work_[c] = work;
  }
}

void IncrementalSolver::markTouched() {
  sortUnique(touched_);
  for (const VariableId v : touched_)
    for (int c = tree_.cliqueOf(v); c >= 0 && work_[c] != Work::kRemoved; c = tree_[c].parent) {
      work_[c] = Work::kRemoved;
      removed_cliques_.push_back(c);
    }
}

void IncrementalSolver::workThroughDirtyCliques() {
  std::ranges::sort(dirty_, {}, [&](int c) { return tree_.sequence(c); });
  for (const int c : dirty_) {
    if (work_[c] == Work::kRefresh) {
      tree_.refresh(c);
    } else {
      const int parent = tree_[c].parent;
      const bool passed_on = parent >= 0 && work_[parent] == Work::kShift;
      std::span<double> parent_change;
      if (passed_on)
        parent_change = {changes_.data() + change_begin_[parent], static_cast<std::size_t>(tree_[parent].size)};
      tree_.shiftRightHandSide(c, {changes_.data() + change_begin_[c], static_cast<std::size_t>(tree_[c].size)},
                               parent_change);
    }
  }
}

void IncrementalSolver::rebuildTop() {
  removed_.clear();
  for (const int c : removed_cliques_) work_[c] = Work::kNone;
  tree_.remove(removed_cliques_, removed_);
  removed_.variables.insert(removed_.variables.end(), new_variables_.begin(), new_variables_.end());
  removed_.factors.insert(removed_.factors.end(), new_factors_.begin(), new_factors_.end());
  if (removed_.variables.empty()) return;
  const bool reorder = params_.policy == Policy::kFluid;
  const auto order = reorder ? reordered_(removed_.variables, removed_.factors, removed_.orphans, touched_)
                             : std::span<const VariableId>(removed_.variables);
  tree_.eliminate({.order = order, .boundary = {}, .factors = removed_.factors, .orphans = removed_.orphans}, created_);
  work_.resize(tree_.slots(), Work::kNone);
  change_begin_.resize(tree_.slots());
  for (const int c : created_) work_[c] = Work::kNew;
}

/// Back-substitution from the roots downwards, as far as anything changed.
void IncrementalSolver::substitute() {
  moved_.clear();
  moved_in_step_.resize(graph_.slots(), 0);
  open_.clear();
  for (const int root : tree_.roots())
    if (work_[root] != Work::kNone) open_.push_back(root);
  while (!open_.empty()) {
    const int id = open_.back();
    const Clique& clique = tree_[id];
    open_.pop_back();
    work_[id] = Work::kNone;
    solve(clique);
    for (int child = clique.first_child; child >= 0; child = tree_[child].next_sibling) {
      const bool changed =
          work_[child] != Work::kNone ||
          std::ranges::any_of(tree_[child].separator(), [&](VariableId v) { return moved_in_step_[v.value] == step_; });
      if (changed) open_.push_back(child);
    }
  }
  report_.moved.insert(report_.moved.end(), moved_.begin(), moved_.end());
}

void IncrementalSolver::solve(const Clique& clique) {
  x_separator_.clear();
  for (const VariableId v : clique.separator()) {
    const auto& x = graph_[v].x;
    x_separator_.insert(x_separator_.end(), x.begin(), x.begin() + graph_.sizeOf(v));
  }
  x_frontal_.resize(clique.frontal_size);
  backSubstitute(clique.panel, clique.panelStride(), clique.size + 1, clique.frontal_size, x_separator_.data(),
                 x_frontal_.data());
  report_.substituted_scalars += clique.frontal_size;
  std::size_t at = 0;
  for (const VariableId v : clique.frontalVariables()) {
    auto& variable = graph_[v];
    double change = 0, sigmas_squared = 0;
    for (int i = 0; i < variable.size; ++i, ++at) {
      change = std::max(change, std::abs(x_frontal_[at] - variable.x[i]));
      const double step = x_frontal_[at] - variable.x_spread[i];
      sigmas_squared = std::max(sigmas_squared, step * step * variable.information[i]);
      variable.x[i] = x_frontal_[at];
    }
    report_.largest_change = std::max(report_.largest_change, change);
    if (sigmas_squared <= spread_sigmas_ * spread_sigmas_) continue;
    variable.x_spread = variable.x;
    moved_in_step_[v.value] = step_;
    moved_.push_back(v);
  }
}

/// Relinearizes and reorders everything.
void IncrementalSolver::batchStep() {
  ++step_;
  graph_.restartCoordinates();
  report_.relinearized_factors += static_cast<int>(graph_.factorCount());
  off_.clear();
  for (const VariableId v : stale_) staleness_[v.value] = 0;
  stale_.clear();
  removed_cliques_.clear();
  created_.clear();
  work_.resize(tree_.slots(), Work::kNone);
  for (std::size_t c = 0; c < tree_.slots(); ++c)
    if (tree_[static_cast<int>(c)].alive) removed_cliques_.push_back(static_cast<int>(c));
  removed_.clear();
  tree_.remove(removed_cliques_, removed_);
  const std::vector<VariableId> variables = graph_.variables();
  const std::vector<FactorId> factors = graph_.factors();
  for (const FactorId f : factors) graph_.linearize(f);
  if (variables.empty()) return;
  tree_.eliminate(
      {.order = reordered_(variables, factors, {}, touched_), .boundary = {}, .factors = factors, .orphans = {}},
      created_);
  work_.resize(tree_.slots(), Work::kNone);
  change_begin_.resize(tree_.slots());
  for (const int c : created_) work_[c] = Work::kNew;
  ++counters_.reorderings, ++counters_.batch_solves;
  spread_sigmas_ = 0;
  substitute();
  if (params_.policy == Policy::kFluid) compareModels();
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

std::vector<int> IncrementalSolver::withAncestors(std::vector<int> cliques) const {
  sortUnique(cliques);
  std::vector<int> all = cliques;
  for (const int start : cliques)
    for (int c = tree_[start].parent; c >= 0; c = tree_[c].parent) {
      if (std::ranges::binary_search(cliques, c)) break;  // its ancestors are added by its own turn
      all.push_back(c);
    }
  sortUnique(all);
  return all;
}

SolverCounters IncrementalSolver::counters() const {
  SolverCounters counters = counters_;
  counters.variables = static_cast<std::int64_t>(graph_.variableCount());
  counters.factors = static_cast<std::int64_t>(graph_.factorCount());
  counters.chi2 = graph_.totalCost();
  return counters;
}

}  // namespace motorcade
