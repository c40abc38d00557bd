#include "backend/elimination/elimination_tree.hpp"

#include <algorithm>
#include <numeric>

#include "backend/elimination/dense_substitution.hpp"
#include "backend/graph/sort_unique.hpp"

namespace motorcade {
namespace {

constexpr std::int64_t kSequenceStep = std::int64_t{1} << 30;  // leaves room for variables that are lifted in between

}  // namespace

int EliminationTree::cliqueOf(VariableId v) const {
  return static_cast<std::size_t>(v.value) < clique_of_.size() ? clique_of_[v.value] : -1;
}

int EliminationTree::ownerOf(std::span<const VariableId> variables) const {
  return cliqueOf(*std::ranges::min_element(variables, {}, [&](VariableId v) { return sequence_[v.value]; }));
}

std::int64_t EliminationTree::sequence(int clique) const {
  // By the last frontal: the first may have joined its parent's clique past others.
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

void EliminationTree::Removed::clear() {
  variables.clear();
  factors.clear();
  orphans.clear();
}

void EliminationTree::remove(std::span<const int> cliques, Removed& removed) {
  leaving_.resize(cliques_.size(), 0);
  for (const int id : cliques) leaving_[id] = 1;
  for (const int id : cliques) {
    const Clique& clique = cliques_[id];
    for (const VariableId v : clique.frontalVariables()) {
      removed.variables.push_back(v);
      clique_of_[v.value] = -1;
    }
    removed.factors.insert(removed.factors.end(), clique.factors.begin(), clique.factors.end());
    for (int child = clique.first_child; child >= 0; child = cliques_[child].next_sibling)
      if (!leaving_[child]) removed.orphans.push_back(child);
    const bool below_one_that_stays = clique.parent >= 0 && !leaving_[clique.parent];
    if (below_one_that_stays) cutOff(clique);
  }
  for (const int orphan : removed.orphans) {
    Clique& clique = cliques_[orphan];
    clique.parent = clique.next_sibling = clique.previous_sibling = -1;
  }
  std::erase_if(roots_, [&](int root) { return leaving_[root] != 0; });
  for (const int id : cliques) {
    leaving_[id] = 0;
    release(cliques_[id]);
    free_.push_back(id);
  }
  std::ranges::sort(removed.variables, {}, [&](VariableId v) { return sequence_[v.value]; });
}

/// Takes a clique out of its parent's children.
void EliminationTree::cutOff(const Clique& clique) {
  if (clique.previous_sibling >= 0)
    cliques_[clique.previous_sibling].next_sibling = clique.next_sibling;
  else
    cliques_[clique.parent].first_child = clique.next_sibling;
  if (clique.next_sibling >= 0) cliques_[clique.next_sibling].previous_sibling = clique.previous_sibling;
}

void EliminationTree::release(Clique& clique) {
  pool_.give(clique.panel);
  update_matrices_.give(clique.update_matrix);
  pool_.give(clique.contribution);
  clique.variables.clear();
  clique.row_in_parent.clear();
  clique.factors.clear();
  clique.singular.clear();
  clique.panel = clique.update_matrix = clique.contribution = nullptr;
  clique.parent = clique.first_child = clique.next_sibling = clique.previous_sibling = -1;
  clique.alive = clique.made_again = false;
}

void EliminationTree::attach(int orphan, int parent) {
  Clique &child = cliques_[orphan], &above = cliques_[parent];
  child.parent = parent;
  noteAttached(orphan);
  child.previous_sibling = -1;
  child.next_sibling = above.first_child;
  if (above.first_child >= 0) cliques_[above.first_child].previous_sibling = orphan;
  above.first_child = orphan;
  child.row_in_parent.clear();
  int at = 0;
  for (const VariableId v : above.variables) {
    position_[v.value] = at;
    at += graph_.sizeOf(v);
  }
  for (const VariableId v : child.separator()) child.row_in_parent.push_back(position_[v.value]);
}

void EliminationTree::forget(VariableId v) {
  clique_of_[v.value] = -1;
  sequence_[v.value] = -1;
}

void EliminationTree::removeFactor(int owner, FactorId factor) { std::erase(cliques_[owner].factors, factor); }

void EliminationTree::eliminate(const Elimination& problem, std::vector<int>& created) {
  ++eliminations_;
  clique_of_.resize(graph_.slots(), -1);
  sequence_.resize(graph_.slots(), -1);
  position_.resize(graph_.slots(), -1);
  if (problem.renumber)
    for (const VariableId v : problem.order) sequence_[v.value] = next_sequence_ += kSequenceStep;
  findPattern(problem);

  group_clique_.clear();
  for (const auto& group : pattern_.groups()) group_clique_.push_back(addClique(problem, group));
  const auto cliqueOfTerm = [&](std::size_t term) {
    return group_clique_[pattern_.groupOfTerm(static_cast<int>(term))];
  };
  for (std::size_t f = 0; f < problem.factors.size(); ++f)
    cliques_[cliqueOfTerm(f)].factors.push_back(problem.factors[f]);
  for (std::size_t g = 0; g < group_clique_.size(); ++g) {
    const int above = pattern_.groups()[g].parent, parent = above < 0 ? problem.parent : group_clique_[above];
    if (parent >= 0)
      attach(group_clique_[g], parent);
    else
      roots_.push_back(group_clique_[g]);
  }
  for (std::size_t o = 0; o < problem.orphans.size(); ++o)
    attach(problem.orphans[o], cliqueOfTerm(problem.factors.size() + o));
  for (std::size_t g = group_clique_.size(); g-- > 0;) refresh(group_clique_[g]);
  created.insert(created.end(), group_clique_.begin(), group_clique_.end());
  giveBackOldUpdateMatrices();
}

/// Between the clique's variables in the elimination order and all those above it.
std::int64_t EliminationTree::sequenceAbove(int clique) const {
  std::int64_t above = next_sequence_ + kSequenceStep;
  for (const VariableId v : (*this)[clique].separator()) above = std::min(above, sequence_[v.value]);
  return std::midpoint(sequence(clique), above);
}

bool EliminationTree::lift(VariableId v, std::span<const int> cliques) {
  const int top = cliques.back(), parent = (*this)[top].parent;
  const std::int64_t last = sequence(top), lifted = sequenceAbove(top);
  if (lifted <= last) return false;
  const auto separator = (*this)[top].separator();
  const std::vector<VariableId> boundary(separator.begin(), separator.end());
  Removed removed;
  remove(cliques, removed);
  std::erase(removed.variables, v);
  removed.variables.push_back(v);
  sequence_[v.value] = lifted;
  std::vector<int> created;
  std::erase_if(removed.orphans, [&](int orphan) {
    const bool outside = std::ranges::none_of(
        (*this)[orphan].separator(), [&](VariableId u) { return std::ranges::count(removed.variables, u) > 0; });
    if (outside) attach(orphan, parent);
    return outside;
  });
  eliminate({.order = removed.variables,
             .boundary = boundary,
             .factors = removed.factors,
             .orphans = removed.orphans,
             .parent = parent,
             .renumber = false},
            created);
  return true;
}

/// The terms are the factors, then the separators of the orphans.
void EliminationTree::findPattern(const Elimination& problem) {
  scalars_.clear();
  for (const auto& variables : {problem.order, problem.boundary})
    for (const VariableId v : variables) {
      position_[v.value] = static_cast<int>(scalars_.size());
      scalars_.push_back(graph_.sizeOf(v));
    }
  pattern_.begin(static_cast<int>(problem.order.size()), static_cast<int>(problem.boundary.size()));
  const auto addTerm = [&](std::span<const VariableId> variables) {
    term_positions_.clear();
    for (const VariableId v : variables) term_positions_.push_back(position_[v.value]);
    pattern_.addTerm(term_positions_);
  };
  for (const FactorId f : problem.factors) addTerm(graph_.variablesOf(f));
  for (const int orphan : problem.orphans) addTerm((*this)[orphan].separator());
  pattern_.analyze(scalars_);
}

int EliminationTree::addClique(const Elimination& problem, const EliminationPattern::Group& group) {
  const int id = takeSlot(), count = static_cast<int>(problem.order.size());
  Clique& clique = cliques_[id];
  clique.alive = true;
  clique.frontals = group.frontals;
  for (const int p : pattern_.positions(group))
    clique.variables.push_back(p < count ? problem.order[p] : problem.boundary[p - count]);
  for (const VariableId v : clique.frontalVariables()) clique_of_[v.value] = id;
  layOut(clique);
  return id;
}

int EliminationTree::takeSlot() {
  if (free_.empty()) {
    cliques_.emplace_back();
    return static_cast<int>(cliques_.size()) - 1;
  }
  const int id = free_.back();
  free_.pop_back();
  return id;
}

/// Sizes and memory of a clique from its variables.
void EliminationTree::layOut(Clique& clique) {
  clique.frontal_size = clique.size = 0;
  for (const VariableId v : clique.frontalVariables()) clique.frontal_size += graph_.sizeOf(v);
  for (const VariableId v : clique.variables) clique.size += graph_.sizeOf(v);
  clique.panel = pool_.take(clique.panelLength());
  clique.update_matrix = update_matrices_.take(clique.updateMatrixLength());
  clique.contribution = pool_.take(clique.separatorSize());
}

Eigen::MatrixXd EliminationTree::marginal(std::span<const VariableId> eliminated, std::span<const VariableId> separator,
                                          std::span<const FactorId> factors) {
  Clique clique;
  clique.variables.assign(eliminated.begin(), eliminated.end());
  clique.variables.insert(clique.variables.end(), separator.begin(), separator.end());
  clique.factors.assign(factors.begin(), factors.end());
  clique.frontals = static_cast<int>(eliminated.size());
  layOut(clique);
  front_.eliminate(clique, {});
  release(clique);
  return front_.schurComplement();
}

void EliminationTree::refresh(int id) {
  Clique& clique = cliques_[id];
  makeUpdateMatricesBelow(clique);
  takeUpdateMatrix(clique);
  front_.eliminate(clique, cliques_);
  giveBackThoseMadeAgainBelow(clique);
  eliminated_scalars_ += (*this)[id].frontal_size;
}

void EliminationTree::shiftRightHandSide(int id, std::span<double> change, std::span<double> parent_change) {
  Clique& clique = cliques_[id];
  const int n = clique.frontal_size, rest = clique.separatorSize(), stride = clique.panelStride();
  // d of the change alone, then added to the former d.
  former_.resize(n);
  double* last_row = clique.panel + clique.size;
  for (int j = 0; j < n; ++j) former_[j] = last_row[j * stride];
  forwardSubstitute(clique.panelView(), clique.singular, change.data());
  for (int j = 0; j < n; ++j) last_row[j * stride] += former_[j];
  for (int i = 0; i < rest; ++i) clique.contribution[i] += change[n + i];
  if (parent_change.empty()) return;  // none, or one that is eliminated anew
  int from = n;
  const auto separator = clique.separator();
  for (std::size_t v = 0; v < separator.size(); ++v) {
    const int to = clique.row_in_parent[v], size = graph_.sizeOf(separator[v]);
    for (int i = 0; i < size; ++i) parent_change[to + i] += change[from + i];
    from += size;
  }
}

}  // namespace motorcade
