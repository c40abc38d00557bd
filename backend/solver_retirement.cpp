#include <algorithm>
#include <cassert>

#include "backend/incremental_solver.hpp"
#include "backend/marginal_factor.hpp"

/// How variables leave the solver: marginalised when they are old, cut out when they went wrong.
namespace motorcade {
namespace {

bool contains(std::span<const VariableId> variables, VariableId v) { return std::ranges::find(variables, v) != variables.end(); }

template <class T>
void sortUnique(std::vector<T>& items) {
  std::ranges::sort(items);
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

}  // namespace

/// A connected part of the tree whose cliques hold variables that retire. Any change of order inside it leaves what it passes to its parent
/// as it is, so that retiring costs only this part, wherever it lies.
struct IncrementalSolver::RetiringPart {
  std::vector<int> cliques;
  std::vector<VariableId> boundary;
  int parent = -1;
};

std::vector<IncrementalSolver::RetiringPart> IncrementalSolver::partsWith(std::span<const VariableId> variables) const {
  std::vector<int> cliques;
  for (const VariableId v : variables) {
    const auto with = tree_.cliquesWith(v);
    cliques.insert(cliques.end(), with.begin(), with.end());
  }
  sortUnique(cliques);
  const auto inside = [&](int clique) { return std::ranges::binary_search(cliques, clique); };
  std::vector<RetiringPart> parts;
  for (const int top : cliques) {
    if (inside(tree_[top].parent)) continue;
    const auto separator = tree_[top].separator();
    parts.push_back({.cliques = {top}, .boundary = {separator.begin(), separator.end()}, .parent = tree_[top].parent});
    auto& part = parts.back().cliques;
    for (std::size_t i = 0; i < part.size(); ++i) std::ranges::copy_if(tree_[part[i]].children, std::back_inserter(part), inside);
  }
  return parts;
}

void IncrementalSolver::retire(std::span<const VariableId> variables) {
  assert(touched_.empty() && new_variables_.empty());
  for (const RetiringPart& part : partsWith(variables)) retirePart(part, variables);
  counters_.retired_variables += static_cast<std::int64_t>(variables.size());
}

void IncrementalSolver::retirePart(const RetiringPart& part, std::span<const VariableId> gone) {
  const auto removed = tree_.remove(part.cliques);
  std::vector<VariableId> leaving, staying;
  for (const VariableId v : removed.variables) (contains(gone, v) ? leaving : staying).push_back(v);

  // The factors of those that leave, and the neighbours on whom their knowledge falls.
  std::vector<FactorId> factors;
  std::vector<VariableId> front_variables = leaving, neighbours;
  for (const VariableId v : leaving) factors.insert(factors.end(), graph_[v].factors.begin(), graph_[v].factors.end());
  sortUnique(factors);
  std::vector<Contribution> known;
  for (const FactorId f : factors) {
    known.push_back({graph_.factor(f).variables(), &graph_.term(f), -1});
    std::ranges::copy_if(graph_.factor(f).variables(), std::back_inserter(neighbours), [&](VariableId v) { return !contains(leaving, v); });
  }
  sortUnique(neighbours);
  front_variables.insert(front_variables.end(), neighbours.begin(), neighbours.end());
  std::vector<int> offset(graph_.slots(), 0);
  std::vector<double> workspace;
  Front front = assembleFront(front_variables, known, graph_, offset, workspace);
  int eliminated = 0;
  for (const VariableId v : leaving) eliminated += graph_.sizeOf(v);
  eliminateFront(front, eliminated);

  for (const FactorId f : factors) graph_.removeFactor(f);
  for (const VariableId v : leaving) {
    tree_.forget(v);
    graph_.removeVariable(v);
  }
  if (!neighbours.empty()) {
    std::vector<Value> values;
    for (const VariableId v : neighbours) values.push_back(graph_[v].linearization_point);
    const Eigen::Index rest = front.rows() - eliminated;
    graph_.addFactor(std::make_unique<MarginalFactor>(neighbours, std::move(values), front.bottomRightCorner(rest, rest)));
  }

  std::vector<int> orphans;
  for (const int orphan : removed.orphans) {
    const auto separator = tree_[orphan].separator();
    const bool outside = std::ranges::none_of(separator, [&](VariableId v) { return contains(staying, v); });
    if (outside)
      tree_.attach(orphan, part.parent);
    else
      orphans.push_back(orphan);
  }
  if (staying.empty()) return;
  Elimination problem{.order = staying, .boundary = part.boundary, .contributions = {}, .parent = part.parent};
  problem.contributions = contributionsOf(staying, part.boundary, orphans);
  tree_.eliminate(problem, graph_, false);
}

IncrementalSolver::Report IncrementalSolver::drop(std::span<const VariableId> variables) {
  assert(touched_.empty() && new_variables_.empty());
  std::vector<int> cliques;
  std::vector<FactorId> factors;
  for (const VariableId v : variables) {
    const auto with = tree_.cliquesWith(v);
    cliques.insert(cliques.end(), with.begin(), with.end());
    factors.insert(factors.end(), graph_[v].factors.begin(), graph_[v].factors.end());
  }
  sortUnique(factors);
  for (const FactorId f : factors)
    for (const VariableId v : graph_.factor(f).variables()) cliques.push_back(tree_.cliqueOf(v));
  auto removed = tree_.remove(withAncestors(std::move(cliques)));

  for (const FactorId f : factors) {
    const auto* marginal = dynamic_cast<const MarginalFactor*>(&graph_.factor(f));
    auto reduced = marginal ? marginal->without(variables) : nullptr;
    graph_.removeFactor(f);
    if (reduced) graph_.addFactor(std::move(reduced));
  }
  for (const VariableId v : variables) {
    std::erase(removed.variables, v);
    tree_.forget(v);
    graph_.removeVariable(v);
  }
  Report report;
  rebuild(std::move(removed.variables), removed.orphans, Order::kKeep, report);
  return report;
}

}  // namespace motorcade
