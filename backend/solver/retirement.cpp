#include <algorithm>
#include <cassert>

#include "backend/graph/marginal_factor.hpp"
#include "backend/solver/incremental_solver.hpp"

/// How variables leave the solver: marginalized when they are old, cut out when they went wrong.
namespace motorcade {
namespace {

bool contains(std::span<const VariableId> variables, VariableId v) {
  return std::ranges::find(variables, v) != variables.end();
}

template <class T>
void sortUnique(std::vector<T>& items) {
  std::ranges::sort(items);
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

/// What the eliminated variables knew, stated in the coordinates of `neighbors`, as a prior around their present
/// estimates.
std::unique_ptr<MarginalFactor> marginalPrior(FactorGraph& graph, const std::vector<VariableId>& neighbors,
                                              Eigen::MatrixXd knowledge) {
  const Eigen::Index n = knowledge.rows() - 1;
  Eigen::VectorXd x(n);
  std::vector<Value> values;
  Eigen::Index at = 0;
  for (const VariableId v : neighbors) {
    graph.apply(v);
    values.push_back(graph[v].applied_estimate);
    for (std::size_t i = 0; i < static_cast<std::size_t>(graph.sizeOf(v)); ++i) x[at++] = graph[v].x_applied[i];
  }
  const Eigen::VectorXd Hx = knowledge.topLeftCorner(n, n).selfadjointView<Eigen::Lower>() * x;
  knowledge(n, n) += x.dot(Hx) + 2 * x.dot(knowledge.row(n).head(n));
  knowledge.row(n).head(n) += Hx.transpose();
  return std::make_unique<MarginalFactor>(neighbors, std::move(values), std::move(knowledge));
}

}  // namespace

/// A connected part of the tree whose cliques hold variables that retire. Any change of order inside it leaves what it
/// passes to its parent as it is, so that retiring costs only this part, wherever it lies.
struct IncrementalSolver::RetiringPart {
  std::vector<int> cliques;
  std::vector<VariableId> boundary;
  int parent = -1;
};

std::vector<IncrementalSolver::RetiringPart> IncrementalSolver::partsWith(std::span<const VariableId> variables) const {
  std::vector<int> cliques;
  for (const VariableId v : variables) {
    tree_.appendCliquesWith(v, cliques);
  }
  sortUnique(cliques);
  const auto inside = [&](int clique) { return std::ranges::binary_search(cliques, clique); };
  std::vector<RetiringPart> parts;
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

void IncrementalSolver::retire(std::span<const VariableId> variables) {
  assert(touched_.empty() && new_variables_.empty());
  for (const RetiringPart& part : partsWith(variables)) retirePart(part, variables);
  counters_.retired_variables += static_cast<std::int64_t>(variables.size());
}

void IncrementalSolver::retirePart(const RetiringPart& part, std::span<const VariableId> gone) {
  removed_.clear();
  tree_.remove(part.cliques, removed_);
  std::vector<VariableId> leaving, staying;
  for (const VariableId v : removed_.variables) (contains(gone, v) ? leaving : staying).push_back(v);

  // The factors of those that leave, and the neighbors on whom their knowledge falls.
  std::vector<FactorId> factors, kept;
  std::vector<VariableId> neighbors;
  for (const VariableId v : leaving) factors.insert(factors.end(), graph_[v].factors.begin(), graph_[v].factors.end());
  sortUnique(factors);
  std::ranges::copy_if(removed_.factors, std::back_inserter(kept),
                       [&](FactorId f) { return !std::ranges::binary_search(factors, f); });
  for (const FactorId f : factors)
    std::ranges::copy_if(graph_.factor(f).variables(), std::back_inserter(neighbors),
                         [&](VariableId v) { return !contains(leaving, v); });
  sortUnique(neighbors);
  auto knowledge = tree_.marginal(leaving, neighbors, factors);

  for (const FactorId f : factors) graph_.removeFactor(f);
  for (const VariableId v : leaving) {
    tree_.forget(v);
    graph_.removeVariable(v);
  }
  if (!neighbors.empty()) {
    const auto prior = graph_.addFactor(marginalPrior(graph_, neighbors, std::move(knowledge)));
    const bool inside = std::ranges::any_of(neighbors, [&](VariableId v) { return contains(staying, v); });
    if (prior && inside) kept.push_back(*prior);
    if (prior && !inside) tree_.addFactor(tree_.ownerOf(graph_.factor(*prior)), *prior);
  }

  std::vector<int> orphans;
  for (const int orphan : removed_.orphans) {
    const auto separator = tree_[orphan].separator();
    const bool outside = std::ranges::none_of(separator, [&](VariableId v) { return contains(staying, v); });
    if (outside)
      tree_.attach(orphan, part.parent);
    else
      orphans.push_back(orphan);
  }
  if (staying.empty()) return;
  created_.clear();
  tree_.eliminate({.order = staying,
                   .boundary = part.boundary,
                   .factors = kept,
                   .orphans = orphans,
                   .parent = part.parent,
                   .renumber = false},
                  created_);
}

const IncrementalSolver::Report& IncrementalSolver::drop(std::span<const VariableId> variables) {
  assert(touched_.empty() && new_variables_.empty());
  beginReport();
  std::vector<FactorId> factors;
  std::vector<int> cliques;
  for (const VariableId v : variables) {
    tree_.appendCliquesWith(v, cliques);
    factors.insert(factors.end(), graph_[v].factors.begin(), graph_[v].factors.end());
  }
  sortUnique(factors);
  for (const FactorId f : factors)
    for (const VariableId v : graph_.factor(f).variables()) cliques.push_back(tree_.cliqueOf(v));
  const auto all = withAncestors(std::move(cliques));
  removed_.clear();
  tree_.remove(all, removed_);

  std::vector<FactorId> kept;
  std::ranges::copy_if(removed_.factors, std::back_inserter(kept),
                       [&](FactorId f) { return !std::ranges::binary_search(factors, f); });
  for (const FactorId f : factors) {
    const auto* marginal = dynamic_cast<const MarginalFactor*>(&graph_.factor(f));
    auto reduced = marginal ? marginal->without(variables) : nullptr;
    graph_.removeFactor(f);
    if (!reduced) continue;
    if (const auto id = graph_.addFactor(std::move(reduced))) kept.push_back(*id);
  }
  for (const VariableId v : variables) {
    std::erase(removed_.variables, v);
    tree_.forget(v);
    graph_.removeVariable(v);
  }
  ++step_;
  created_.clear();
  tree_.eliminate(
      {.order = removed_.variables, .boundary = {}, .factors = kept, .orphans = removed_.orphans, .renumber = false},
      created_);
  work_.assign(tree_.slots(), Work::kNone);
  for (const int c : created_) work_[c] = Work::kNew;
  substitute();
  if (params_.policy == Policy::kFluid) compareModels();
  endReport();
  return report_;
}

}  // namespace motorcade
