#include "backend/elimination/elimination_tree.hpp"

#include <algorithm>
#include <numeric>

#include "backend/graph/sort_unique.hpp"

namespace motorcade {
namespace {

constexpr std::int64_t kSequenceStep = std::int64_t{1} << 30;  // leaves room for variables that are lifted in between

/// Empties a clique's slot, which keeps the memory of its lists.
void clear(Clique& clique) {
  clique.variables.clear();
  clique.row_in_parent.clear();
  clique.factors.clear();
  clique.singular.clear();
  clique.parent = clique.first_child = clique.next_sibling = clique.previous_sibling = -1;
  clique.alive = clique.made_again = false;
}

}  // namespace

int EliminationTree::ownerOf(std::span<const VariableId> variables) const {
  VariableId first = variables.front();
  std::int64_t least = sequence_[first.value];
  for (const VariableId v : variables.subspan(1))
    if (const std::int64_t sequence = sequence_[v.value]; sequence < least) first = v, least = sequence;
  return cliqueOf(first);
}

std::int64_t EliminationTree::sequence(int clique) const {
  // The last frontal tells it: the first may have joined its parent's clique past others.
  return sequence_[(*this)[clique].frontalVariables().back().value];
}

void EliminationTree::appendCliquesWith(VariableId v, std::vector<int>& found) const {
  std::size_t next = found.size();
  if (cliqueOf(v) < 0) return;
  found.push_back(cliqueOf(v));
  for (; next < found.size(); ++next)
    for (int child = (*this)[found[next]].first_child; child >= 0; child = (*this)[child].next_sibling)
      if (std::ranges::find((*this)[child].separator(), v) != (*this)[child].separator().end()) found.push_back(child);
}

std::vector<int> EliminationTree::withAncestors(std::vector<int> cliques) const {
  sortUnique(cliques);
  std::vector<int> all = cliques;
  for (const int start : cliques)
    for (int c = (*this)[start].parent; c >= 0; c = (*this)[c].parent) {
      if (std::ranges::binary_search(cliques, c)) break;  // its ancestors are added by its own turn
      all.push_back(c);
    }
  sortUnique(all);
  return all;
}

std::vector<int> EliminationTree::cliques() const {
  std::vector<int> alive;
  for (int c = 0; c < static_cast<int>(slots()); ++c)
    if ((*this)[c].alive) alive.push_back(c);
  return alive;
}

int EliminationTree::rootOf(int clique) const {
  while ((*this)[clique].parent >= 0) clique = (*this)[clique].parent;
  return clique;
}

void EliminationTree::makeRoom(std::size_t slots) {
  clique_of_.resize(slots, -1);
  sequence_.resize(slots, -1);
}

void EliminationTree::appendToOrder(std::span<const VariableId> variables) {
  for (const VariableId v : variables) sequence_[v.value] = next_sequence_ += kSequenceStep;
}

bool EliminationTree::putBehind(VariableId v, int clique) {
  std::int64_t above = next_sequence_ + kSequenceStep;
  for (const VariableId u : (*this)[clique].separator()) above = std::min(above, sequence_[u.value]);
  const std::int64_t last = sequence(clique), between = std::midpoint(last, above);
  if (between <= last) return false;
  sequence_[v.value] = between;
  return true;
}

void EliminationTree::moveFrontalUp(int clique) {
  Clique &below = cliques_[clique], &above = cliques_[below.parent];
  const VariableId v = below.frontalVariables().back();
  --below.frontals;
  above.variables.insert(above.variables.begin() + above.frontals, v);
  ++above.frontals;
  clique_of_[v.value] = below.parent;
}

void EliminationTree::forget(VariableId v) {
  clique_of_[v.value] = -1;
  sequence_[v.value] = -1;
}

int EliminationTree::add(std::span<const VariableId> variables, int frontals) {
  if (free_.empty()) {
    free_.push_back(static_cast<int>(slots()));
    cliques_.emplace_back();
  }
  const int id = free_.back();
  free_.pop_back();
  Clique& clique = cliques_[id];
  clique.alive = true;
  clique.frontals = frontals;
  clique.variables.assign(variables.begin(), variables.end());
  for (const VariableId v : clique.frontalVariables()) clique_of_[v.value] = id;
  return id;
}

void EliminationTree::hang(int clique, int parent) {
  if (parent < 0) {
    roots_.push_back(clique);
    return;
  }
  Clique &child = cliques_[clique], &above = cliques_[parent];
  child.parent = parent;
  child.previous_sibling = -1;
  child.next_sibling = above.first_child;
  if (above.first_child >= 0) cliques_[above.first_child].previous_sibling = clique;
  above.first_child = clique;
}

EliminationTree::Removed& EliminationTree::remove(std::span<const int> cliques) {
  auto& [variables, factors, orphans] = removed_;
  variables.clear(), factors.clear(), orphans.clear();
  leaving_.resize(cliques_.size(), 0);
  for (const int id : cliques) leaving_[id] = 1;
  for (const int id : cliques) {
    const Clique& clique = cliques_[id];
    for (const VariableId v : clique.frontalVariables()) {
      variables.push_back(v);
      clique_of_[v.value] = -1;
    }
    factors.insert(factors.end(), clique.factors.begin(), clique.factors.end());
    for (int child = clique.first_child; child >= 0; child = cliques_[child].next_sibling)
      if (!leaving_[child]) orphans.push_back(child);
    const bool below_one_that_stays = clique.parent >= 0 && !leaving_[clique.parent];
    if (below_one_that_stays) cutOff(clique);
  }
  for (const int orphan : orphans) {
    Clique& clique = cliques_[orphan];
    clique.parent = clique.next_sibling = clique.previous_sibling = -1;
  }
  std::erase_if(roots_, [&](int root) { return leaving_[root] != 0; });
  for (const int id : cliques) {
    leaving_[id] = 0;
    clear(cliques_[id]);
    free_.push_back(id);
  }
  std::ranges::sort(variables, {}, [&](VariableId v) { return sequence_[v.value]; });
  return removed_;
}

/// Takes a clique out of its parent's children.
void EliminationTree::cutOff(const Clique& clique) {
  if (clique.previous_sibling >= 0)
    cliques_[clique.previous_sibling].next_sibling = clique.next_sibling;
  else
    cliques_[clique.parent].first_child = clique.next_sibling;
  if (clique.next_sibling >= 0) cliques_[clique.next_sibling].previous_sibling = clique.previous_sibling;
}

}  // namespace motorcade
