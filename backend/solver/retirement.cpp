#include "backend/solver/retirement.hpp"

#include <algorithm>

#include "backend/graph/marginal_factor.hpp"
#include "backend/graph/sort_unique.hpp"

namespace motorcade {
namespace {

bool contains(std::span<const VariableId> variables, VariableId v) {
  return std::ranges::find(variables, v) != variables.end();
}

/// Variables of the factors without those that leave.
std::vector<VariableId> neighborsOf(const FactorGraph& graph, std::span<const FactorId> factors,
                                    std::span<const VariableId> leaving) {
  std::vector<VariableId> neighbors;
  for (const FactorId f : factors)
    std::ranges::copy_if(graph.variablesOf(f), std::back_inserter(neighbors),
                         [&](VariableId v) { return !contains(leaving, v); });
  sortUnique(neighbors);
  return neighbors;
}

/// Factors without the sorted `others`.
std::vector<FactorId> without(const std::vector<FactorId>& others, std::span<const FactorId> factors) {
  std::vector<FactorId> kept;
  std::ranges::copy_if(factors, std::back_inserter(kept),
                       [&](FactorId f) { return !std::ranges::binary_search(others, f); });
  return kept;
}

/// Prior around the present estimates of `neighbors`, from the eliminated variables' information in their coordinates.
std::unique_ptr<MarginalFactor> marginalPrior(FactorGraph& graph, const std::vector<VariableId>& neighbors,
                                              Eigen::MatrixXd knowledge) {
  const Eigen::Index n = knowledge.rows() - 1;
  Eigen::VectorXd x(n);
  std::vector<Value> values;
  Eigen::Index at = 0;
  for (const VariableId v : neighbors) {
    graph.states().apply(v);
    const VariableState& state = graph.states()[v];
    values.push_back(state.applied_estimate);
    for (int i = 0; i < state.size; ++i) x[at++] = state.x_applied[i];
  }
  const Eigen::VectorXd Hx = knowledge.topLeftCorner(n, n).selfadjointView<Eigen::Lower>() * x;
  knowledge(n, n) += x.dot(Hx) + 2 * x.dot(knowledge.row(n).head(n));
  knowledge.row(n).head(n) += Hx.transpose();
  return std::make_unique<MarginalFactor>(neighbors, std::move(values), std::move(knowledge));
}

}  // namespace

void Retirement::marginalize(std::span<const VariableId> variables) {
  for (const Part& part : partsWith(variables)) retirePart(part, variables);
}

std::vector<Retirement::Part> Retirement::partsWith(std::span<const VariableId> variables) const {
  std::vector<int> cliques;
  for (const VariableId v : variables) tree_.appendCliquesWith(v, cliques);
  sortUnique(cliques);
  const auto inside = [&](int clique) { return std::ranges::binary_search(cliques, clique); };
  std::vector<Part> parts;
  for (const int top : cliques) {
    if (tree_[top].parent >= 0 && inside(tree_[top].parent)) continue;
    const auto separator = tree_[top].separator();
    parts.push_back({.cliques = {top}, .boundary = {separator.begin(), separator.end()}, .parent = tree_[top].parent});
    auto& part = parts.back().cliques;
    for (std::size_t i = 0; i < part.size(); ++i)
      for (int child = tree_[part[i]].first_child; child >= 0; child = tree_[child].next_sibling)
        if (inside(child)) part.push_back(child);
  }
  return parts;
}

void Retirement::retirePart(const Part& part, std::span<const VariableId> gone) {
  const auto& removed = eliminator_.remove(part.cliques);
  std::vector<VariableId> leaving, staying;
  for (const VariableId v : removed.variables) (contains(gone, v) ? leaving : staying).push_back(v);

  std::vector<FactorId> factors = factorsOf(leaving);
  const std::vector<VariableId> neighbors = neighborsOf(graph_, factors, leaving);
  includeEarlierPriors(neighbors, factors);
  std::vector<FactorId> kept = without(factors, removed.factors);
  auto knowledge = eliminator_.marginal(leaving, neighbors, factors);
  for (const FactorId f : factors) graph_.removeFactor(f);
  forget(leaving);
  if (!neighbors.empty()) {
    const auto prior = graph_.addFactor(marginalPrior(graph_, neighbors, std::move(knowledge)));
    const bool inside = std::ranges::any_of(neighbors, [&](VariableId v) { return contains(staying, v); });
    if (prior && inside) kept.push_back(*prior);
    if (prior && !inside) tree_.addFactor(tree_.ownerOf(graph_.variablesOf(*prior)), *prior);
  }
  eliminator_.eliminate({.order = staying,
                         .boundary = part.boundary,
                         .factors = kept,
                         .orphans = removed.orphans,
                         .parent = part.parent,
                         .renumber = false});
}

/// Includes priors that earlier retirements left on the same variable: on one that all share, they would grow without
/// end.
void Retirement::includeEarlierPriors(std::span<const VariableId> neighbors, std::vector<FactorId>& factors) {
  if (neighbors.size() != 1) return;
  for (const FactorId f : graph_.factorsOf(neighbors.front())) {
    if (graph_.variablesOf(f).size() != 1 || graph_.models().isJacobian(f)) continue;
    if (tree_.cliqueOf(neighbors.front()) >= 0) tree_.removeFactor(tree_.ownerOf(graph_.variablesOf(f)), f);
    factors.push_back(f);
  }
  sortUnique(factors);
}

std::span<const int> Retirement::drop(std::span<const VariableId> variables) {
  const std::vector<FactorId> factors = factorsOf(variables);
  std::vector<int> cliques;
  for (const VariableId v : variables) tree_.appendCliquesWith(v, cliques);
  for (const FactorId f : factors)
    for (const VariableId v : graph_.variablesOf(f)) cliques.push_back(tree_.cliqueOf(v));
  auto& removed = eliminator_.remove(tree_.withAncestors(std::move(cliques)));

  std::vector<FactorId> kept = without(factors, removed.factors);
  for (const FactorId f : factors) {
    const InformationFactor* information = graph_.models().informationFactor(f);
    auto reduced = information ? information->without(variables) : nullptr;
    graph_.removeFactor(f);
    if (!reduced) continue;
    if (const auto id = graph_.addFactor(std::move(reduced))) kept.push_back(*id);
  }
  for (const VariableId v : variables) std::erase(removed.variables, v);
  forget(variables);
  return eliminator_.eliminate(
      {.order = removed.variables, .factors = kept, .orphans = removed.orphans, .renumber = false});
}

std::vector<FactorId> Retirement::factorsOf(std::span<const VariableId> variables) const {
  std::vector<FactorId> factors;
  for (const VariableId v : variables)
    factors.insert(factors.end(), graph_.factorsOf(v).begin(), graph_.factorsOf(v).end());
  sortUnique(factors);
  return factors;
}

void Retirement::forget(std::span<const VariableId> variables) {
  for (const VariableId v : variables) {
    tree_.forget(v);
    graph_.removeVariable(v);
  }
}

}  // namespace motorcade
