#include "backend/incremental_solver.hpp"

#include <algorithm>
#include <cassert>

#include "backend/ordering.hpp"

namespace motorcade {
namespace {

std::size_t index(VariableId v) { return static_cast<std::size_t>(v.value); }

template <class T>
void sortUnique(std::vector<T>& items) {
  std::ranges::sort(items);
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

}  // namespace

VariableId IncrementalSolver::addVariable(const Value& initial) {
  const VariableId v = graph_.addVariable(initial);
  new_variables_.push_back(v);
  return v;
}

std::optional<FactorId> IncrementalSolver::addFactor(std::unique_ptr<const Factor> factor) {
  const auto id = graph_.addFactor(std::move(factor));
  if (!id) return std::nullopt;
  const auto variables = graph_.factor(*id).variables();
  touched_.insert(touched_.end(), variables.begin(), variables.end());
  return id;
}

void IncrementalSolver::removeFactor(FactorId id) {
  const auto variables = graph_.factor(id).variables();
  touched_.insert(touched_.end(), variables.begin(), variables.end());
  graph_.removeFactor(id);
}

IncrementalSolver::Report IncrementalSolver::update() {
  Report report;
  ++counters_.updates;
  sortUnique(touched_);
  if (params_.policy == Policy::kEveryN && counters_.updates % params_.batch_every_updates == 0) {
    batchStep(report);
  } else {
    std::vector<int> cliques;
    for (const VariableId v : touched_)
      if (tree_.cliqueOf(v) >= 0) cliques.push_back(tree_.cliqueOf(v));
    if (params_.policy == Policy::kFluid) {
      const auto moved = movedVariables();
      report.relinearized_variables = static_cast<int>(moved.size());
      if (!moved.empty()) ++counters_.relinearizations;
      const auto dependent = relinearize(moved);
      cliques.insert(cliques.end(), dependent.begin(), dependent.end());
    }
    auto removed = tree_.remove(withAncestors(std::move(cliques)));
    removed.variables.insert(removed.variables.end(), new_variables_.begin(), new_variables_.end());
    rebuild(std::move(removed.variables), removed.orphans, params_.policy == Policy::kFluid ? Order::kReorder : Order::kKeep, report);
  }
  touched_.clear();
  new_variables_.clear();
  return report;
}

void IncrementalSolver::batchStep(Report& report) {
  const auto variables = graph_.variables();
  relinearize(variables);
  std::vector<int> cliques;
  for (const VariableId v : variables)
    if (tree_.cliqueOf(v) >= 0) cliques.push_back(tree_.cliqueOf(v));
  sortUnique(cliques);
  tree_.remove(cliques);
  ++counters_.relinearizations, ++counters_.reorderings, ++counters_.batch_solves;
  report.relinearized_variables = static_cast<int>(variables.size());
  rebuild(variables, {}, Order::kReorder, report);
}

IncrementalSolver::Report IncrementalSolver::converge(int max_iterations, double tolerance) {
  Report report;
  for (int i = 0; i < max_iterations; ++i) {
    report = {};
    batchStep(report);
    if (report.largest_change < tolerance) break;
  }
  touched_.clear();
  new_variables_.clear();
  return report;
}

std::vector<VariableId> IncrementalSolver::movedVariables() const {
  std::vector<VariableId> moved;
  for (const VariableId v : graph_.variables()) {
    const auto& variable = graph_[v];
    const bool pose = std::holds_alternative<SE3>(variable.linearization_point);
    const auto linear = variable.delta.head(pose ? 3 : variable.delta.size());
    const bool turned = pose && variable.delta.tail(3).cwiseAbs().maxCoeff() > params_.relinearize_rad;
    if (turned || linear.cwiseAbs().maxCoeff() > params_.relinearize_m) moved.push_back(v);
  }
  return moved;
}

/// Returns the cliques that depend on the linearisation points of the variables.
std::vector<int> IncrementalSolver::relinearize(std::span<const VariableId> variables) {
  std::vector<int> cliques;
  std::vector<FactorId> factors;
  for (const VariableId v : variables) {
    graph_.moveToEstimate(v);
    const auto with = tree_.cliquesWith(v);
    cliques.insert(cliques.end(), with.begin(), with.end());
    factors.insert(factors.end(), graph_[v].factors.begin(), graph_[v].factors.end());
  }
  sortUnique(factors);
  for (const FactorId f : factors) {
    graph_.linearize(f);
    for (const VariableId v : graph_.factor(f).variables())
      if (tree_.cliqueOf(v) >= 0) cliques.push_back(tree_.cliqueOf(v));
  }
  return cliques;
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

/// Factors whose variables all lie among `variables` and `boundary`, at least one among `variables`; and what the orphans left.
std::vector<Contribution> IncrementalSolver::contributionsOf(std::span<const VariableId> variables, std::span<const VariableId> boundary,
                                                             std::span<const int> orphans) {
  marked_.resize(graph_.slots(), 0);
  for (const VariableId v : variables) marked_[index(v)] = 1;
  for (const VariableId v : boundary) marked_[index(v)] = 2;
  std::vector<Contribution> contributions;
  for (const VariableId v : variables) {
    for (const FactorId f : graph_[v].factors) {
      const auto members = graph_.factor(f).variables();
      const auto owner = std::ranges::find_if(members, [&](VariableId m) { return marked_[index(m)] == 1; });
      const bool complete = std::ranges::all_of(members, [&](VariableId m) { return marked_[index(m)] != 0; });
      if (complete && *owner == v) contributions.push_back({members, &graph_.term(f), -1});
    }
  }
  for (const int orphan : orphans) contributions.push_back({tree_[orphan].separator(), &tree_[orphan].remainder, orphan});
  for (const VariableId v : variables) marked_[index(v)] = 0;
  for (const VariableId v : boundary) marked_[index(v)] = 0;
  return contributions;
}

/// The variables with little fill, those that the newest factors touch last: they will be touched again next.
std::vector<VariableId> IncrementalSolver::reordered(std::span<const VariableId> variables,
                                                     std::span<const Contribution> contributions) const {
  std::vector<int> column(graph_.slots(), -1), group(variables.size(), 0);
  for (std::size_t i = 0; i < variables.size(); ++i) {
    column[index(variables[i])] = static_cast<int>(i);
    if (std::ranges::binary_search(touched_, variables[i])) group[i] = 1;
  }
  std::vector<std::vector<int>> rows;
  for (const Contribution& c : contributions) {
    rows.emplace_back();
    for (const VariableId v : c.variables) rows.back().push_back(column[index(v)]);
  }
  // CCOLAMD wants at least one row in each column.
  for (std::size_t i = 0; i < variables.size(); ++i) rows.push_back({static_cast<int>(i)});
  std::vector<VariableId> order;
  for (const int c : eliminationOrder(static_cast<int>(variables.size()), rows, group))
    order.push_back(variables[static_cast<std::size_t>(c)]);
  return order;
}

void IncrementalSolver::rebuild(std::vector<VariableId> variables, std::span<const int> orphans, Order order, Report& report) {
  if (variables.empty()) return;
  Elimination problem;
  problem.contributions = contributionsOf(variables, {}, orphans);
  problem.order = order == Order::kReorder ? reordered(variables, problem.contributions) : std::move(variables);
  const auto result = tree_.eliminate(problem, graph_, order == Order::kReorder);
  report.singular.insert(report.singular.end(), result.singular.begin(), result.singular.end());
  report.eliminated_scalars += result.eliminated_scalars;
  substitute(result.cliques, report);
}

/// Back-substitution from the new cliques downwards, as far as anything changes.
void IncrementalSolver::substitute(std::span<const int> new_cliques, Report& report) {
  delta_changed_.assign(graph_.slots(), 0);
  for (const int id : new_cliques) solve(tree_[id], true, report);
  std::vector<int> is_new(new_cliques.begin(), new_cliques.end());
  std::ranges::sort(is_new);
  std::vector<int> below;
  for (const int id : new_cliques)
    for (const int child : tree_[id].children)
      if (!std::ranges::binary_search(is_new, child)) below.push_back(child);
  while (!below.empty()) {
    const Clique& clique = tree_[below.back()];
    below.pop_back();
    if (std::ranges::none_of(clique.separator(), [&](VariableId v) { return delta_changed_[index(v)] != 0; })) continue;
    if (solve(clique, false, report)) below.insert(below.end(), clique.children.begin(), clique.children.end());
  }
}

/// True when the subtree below may have to change.
bool IncrementalSolver::solve(const Clique& clique, bool is_new, Report& report) {
  const int n = clique.frontal_size, rest = clique.size - n;
  Eigen::VectorXd right = -clique.L.row(clique.size).transpose();
  bool spreads = is_new;
  if (rest > 0) {
    Eigen::VectorXd x(rest);
    int at = 0;
    for (const VariableId v : clique.separator()) {
      x.segment(at, graph_.sizeOf(v)) = graph_[v].delta;
      at += graph_.sizeOf(v);
      spreads |= delta_changed_[index(v)] != 0;
    }
    right.noalias() -= clique.L.middleRows(n, rest).transpose() * x;
  }
  clique.L.topRows(n).triangularView<Eigen::Lower>().transpose().solveInPlace(right);
  int at = 0;
  for (const VariableId v : clique.frontalVariables()) {
    auto& delta = graph_[v].delta;
    const auto solution = right.segment(at, delta.size());
    at += static_cast<int>(delta.size());
    const double change = (solution - delta).cwiseAbs().maxCoeff();
    report.largest_change = std::max(report.largest_change, change);
    if (change > params_.substitution_threshold) delta_changed_[index(v)] = 1;
    if (is_new || change > params_.substitution_threshold) delta = solution;
  }
  return spreads;
}

SolverCounters IncrementalSolver::counters() const {
  SolverCounters counters = counters_;
  counters.variables = static_cast<std::int64_t>(graph_.variableCount());
  counters.factors = static_cast<std::int64_t>(graph_.factorCount());
  for (const int root : tree_.roots()) {
    const auto& left = tree_[root].remainder.matrix;  // what no variable explains: the minimum of the linearised cost
    counters.chi2 += left(left.rows() - 1, left.cols() - 1);
  }
  return counters;
}

}  // namespace motorcade
