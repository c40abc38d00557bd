#include "backend/elimination_tree.hpp"

#include <algorithm>
#include <cassert>

namespace motorcade {
namespace {

std::size_t index(VariableId v) { return static_cast<std::size_t>(v.value); }
std::size_t index(int i) { return static_cast<std::size_t>(i); }

}  // namespace

/// The pattern of the result: positions count `order`, then `boundary`.
struct EliminationTree::Symbolic {
  struct Group {
    std::vector<int> positions;  // ascending: frontals, then the separator
    int frontals = 0;
    int parent = -1;  // group
    std::vector<const Contribution*> contributions;
  };
  std::vector<Group> groups;  // parents before children
};

int EliminationTree::cliqueOf(VariableId v) const { return index(v) < clique_of_.size() ? clique_of_[index(v)] : -1; }

std::vector<int> EliminationTree::cliquesWith(VariableId v) const {
  std::vector<int> found;
  if (cliqueOf(v) < 0) return found;
  found.push_back(cliqueOf(v));
  for (std::size_t i = 0; i < found.size(); ++i)
    for (const int child : (*this)[found[i]].children)
      if (std::ranges::find((*this)[child].separator(), v) != (*this)[child].separator().end()) found.push_back(child);
  return found;
}

EliminationTree::Removed EliminationTree::remove(std::span<const int> cliques) {
  Removed removed;
  std::vector<int> sorted(cliques.begin(), cliques.end());
  std::ranges::sort(sorted);
  const auto isRemoved = [&](int clique) { return std::ranges::binary_search(sorted, clique); };
  for (const int id : sorted) {
    Clique& clique = cliques_[index(id)];
    for (const VariableId v : clique.frontalVariables()) {
      removed.variables.push_back(v);
      clique_of_[index(v)] = -1;
    }
    for (const int child : clique.children) {
      if (isRemoved(child)) continue;
      cliques_[index(child)].parent = -1;
      removed.orphans.push_back(child);
    }
    if (clique.parent >= 0 && !isRemoved(clique.parent)) std::erase(cliques_[index(clique.parent)].children, id);
  }
  std::erase_if(roots_, isRemoved);
  for (const int id : sorted) {
    cliques_[index(id)] = {};
    free_.push_back(id);
  }
  std::ranges::sort(removed.variables, {}, [&](VariableId v) { return sequence(v); });
  return removed;
}

EliminationTree::Symbolic EliminationTree::analyze(const Elimination& problem) {
  const int count = static_cast<int>(problem.order.size());
  for (int i = 0; i < count; ++i) position_[index(problem.order[index(i)])] = i;
  for (std::size_t i = 0; i < problem.boundary.size(); ++i) position_[index(problem.boundary[i])] = count + static_cast<int>(i);

  // Column structures, each the union of what is first eliminated here and of what the columns below leave over.
  std::vector<std::vector<int>> columns(index(count));
  std::vector<std::vector<const Contribution*>> owned(index(count));
  for (const Contribution& c : problem.contributions) {
    int first = count + static_cast<int>(problem.boundary.size());
    for (const VariableId v : c.variables) first = std::min(first, position_[index(v)]);
    assert(first >= 0 && first < count);
    owned[index(first)].push_back(&c);
    for (const VariableId v : c.variables) columns[index(first)].push_back(position_[index(v)]);
  }
  std::vector<int> parent(index(count), -1);
  for (int j = 0; j < count; ++j) {
    auto& column = columns[index(j)];
    std::ranges::sort(column);
    column.erase(std::unique(column.begin(), column.end()), column.end());
    if (!column.empty() && column.front() == j) column.erase(column.begin());
    if (column.empty() || column.front() >= count) continue;
    parent[index(j)] = column.front();
    auto& above = columns[index(column.front())];
    above.insert(above.end(), column.begin(), column.end());
  }

  // Fundamental supernodes: a column whose separator is all of its parent's clique joins that clique.
  Symbolic symbolic;
  std::vector<int> group_of(index(count), -1);
  for (int j = count - 1; j >= 0; --j) {
    const int above = parent[index(j)] < 0 ? -1 : group_of[index(parent[index(j)])];
    int g = above;
    if (above < 0 || columns[index(j)].size() != symbolic.groups[index(above)].positions.size()) {
      g = static_cast<int>(symbolic.groups.size());
      symbolic.groups.push_back({.positions = columns[index(j)], .frontals = 0, .parent = above, .contributions = {}});
    }
    auto& group = symbolic.groups[index(g)];
    group.positions.insert(group.positions.begin(), j);
    ++group.frontals;
    group.contributions.insert(group.contributions.end(), owned[index(j)].begin(), owned[index(j)].end());
    group_of[index(j)] = g;
  }
  return symbolic;
}

void EliminationTree::attach(int orphan, int parent) {
  cliques_[index(orphan)].parent = parent;
  cliques_[index(parent)].children.push_back(orphan);
}

int EliminationTree::newClique() {
  if (free_.empty()) {
    cliques_.emplace_back();
    return static_cast<int>(cliques_.size()) - 1;
  }
  const int id = free_.back();
  free_.pop_back();
  return id;
}

EliminationTree::Result EliminationTree::eliminate(const Elimination& problem, const FactorGraph& graph, bool renumber) {
  clique_of_.resize(graph.slots(), -1);
  sequence_.resize(graph.slots(), -1);
  position_.resize(graph.slots(), -1);
  offset_.resize(graph.slots(), -1);
  for (const VariableId v : problem.order)
    if (renumber || sequence_[index(v)] < 0) sequence_[index(v)] = next_sequence_++;
  const Symbolic symbolic = analyze(problem);

  Result result;
  for (const auto& group : symbolic.groups) {
    const int id = newClique();
    Clique& clique = cliques_[index(id)];
    clique.parent = group.parent < 0 ? problem.parent : result.cliques[index(group.parent)];
    clique.frontals = group.frontals;
    for (const int p : group.positions) {
      const bool inside = p < static_cast<int>(problem.order.size());
      clique.variables.push_back(inside ? problem.order[index(p)] : problem.boundary[index(p) - problem.order.size()]);
    }
    for (const VariableId v : clique.frontalVariables()) clique_of_[index(v)] = id;
    (clique.parent < 0 ? roots_ : cliques_[index(clique.parent)].children).push_back(id);
    result.cliques.push_back(id);
  }
  for (std::size_t g = symbolic.groups.size(); g-- > 0;) {
    const int id = result.cliques[g];
    for (const Contribution* c : symbolic.groups[g].contributions)
      if (c->child >= 0) attach(c->child, id);
    fill(cliques_[index(id)], symbolic.groups[g].contributions, graph, result);
  }
  return result;
}

void EliminationTree::fill(Clique& clique, std::span<const Contribution* const> contributions, const FactorGraph& graph, Result& result) {
  std::vector<Contribution> all;
  for (const Contribution* c : contributions)
    if (c->child < 0) all.push_back(*c);
  for (const int child : clique.children) all.push_back({cliques_[index(child)].separator(), &cliques_[index(child)].remainder, child});
  Front front = assembleFront(clique.variables, all, graph, offset_, workspace_);
  clique.size = static_cast<int>(front.rows()) - 1;
  clique.frontal_size =
      clique.frontals < static_cast<int>(clique.variables.size()) ? offset_[index(clique.variables[index(clique.frontals)])] : clique.size;
  const auto singular = eliminateFront(front, clique.frontal_size);
  for (const int scalar : singular) {
    std::size_t v = 0;
    while (v + 1 < index(clique.frontals) && offset_[index(clique.variables[v + 1])] <= scalar) ++v;
    result.singular.push_back({clique.variables[v], scalar - offset_[index(clique.variables[v])]});
  }
  const int rest = clique.size + 1 - clique.frontal_size;
  clique.L = front.leftCols(clique.frontal_size);
  clique.remainder.matrix = front.bottomRightCorner(rest, rest);
  result.eliminated_scalars += clique.frontal_size;
}

std::size_t EliminationTree::storedScalars() const {
  std::size_t scalars = 0;
  for (const Clique& c : cliques_) scalars += static_cast<std::size_t>(c.L.size() + c.remainder.matrix.size());
  return scalars;
}

}  // namespace motorcade
