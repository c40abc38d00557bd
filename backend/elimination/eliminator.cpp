#include "backend/elimination/eliminator.hpp"

#include <algorithm>
#include <array>

#include "backend/elimination/dense_substitution.hpp"

namespace motorcade {

std::span<const int> Eliminator::eliminate(const Elimination& problem) {
  tree_.makeRoom(graph_.slots());
  position_.resize(graph_.slots(), -1);
  if (problem.renumber) tree_.appendToOrder(problem.order);
  findPattern(problem);
  for (const int orphan : outside_) attach(orphan, problem.parent);
  created_.clear();
  if (problem.order.empty()) return created_;
  update_matrices_.beginElimination();
  flops_ += kFlopsPerOrdered * static_cast<double>(problem.order.size());
  for (const auto& group : pattern_.groups()) created_.push_back(addClique(problem, group));
  const auto cliqueOfTerm = [&](std::size_t term) { return created_[pattern_.groupOfTerm(static_cast<int>(term))]; };
  for (std::size_t f = 0; f < problem.factors.size(); ++f) tree_.addFactor(cliqueOfTerm(f), problem.factors[f]);
  for (std::size_t g = 0; g < created_.size(); ++g) {
    const int above = pattern_.groups()[g].parent;
    attach(created_[g], above < 0 ? problem.parent : created_[above]);
  }
  for (std::size_t o = 0; o < inside_.size(); ++o) attach(inside_[o], cliqueOfTerm(problem.factors.size() + o));
  for (std::size_t g = created_.size(); g-- > 0;) refresh(created_[g]);
  update_matrices_.giveBackOld();
  return created_;
}

/// Finds the pattern. Its terms are the factors, then the separators of the orphans inside.
void Eliminator::findPattern(const Elimination& problem) {
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
    return pattern_.addTerm(term_positions_);
  };
  for (const FactorId f : problem.factors) addTerm(graph_.variablesOf(f));
  inside_.clear(), outside_.clear();
  for (const int orphan : problem.orphans) (addTerm(tree_[orphan].separator()) ? inside_ : outside_).push_back(orphan);
  pattern_.analyze(scalars_);
}

int Eliminator::addClique(const Elimination& problem, const EliminationPattern::Group& group) {
  const int count = static_cast<int>(problem.order.size());
  variables_.clear();
  for (const int p : pattern_.positions(group))
    variables_.push_back(p < count ? problem.order[p] : problem.boundary[p - count]);
  const int id = tree_.add(variables_, group.frontals);
  layOut(tree_[id]);
  return id;
}

/// Hangs a clique below one that holds its whole separator, or makes it a root.
void Eliminator::attach(int clique, int parent) {
  tree_.hang(clique, parent);
  if (parent < 0) return;
  update_matrices_.noteAttached(clique);
  int at = 0;
  for (const VariableId v : tree_[parent].variables) {
    position_[v.value] = at;
    at += graph_.sizeOf(v);
  }
  Clique& child = tree_[clique];
  child.row_in_parent.clear();
  for (const VariableId v : child.separator()) child.row_in_parent.push_back(position_[v.value]);
}

/// Sets the sizes and the memory of a clique from its variables.
void Eliminator::layOut(Clique& clique) {
  clique.frontal_size = clique.size = 0;
  for (const VariableId v : clique.frontalVariables()) clique.frontal_size += graph_.sizeOf(v);
  for (const VariableId v : clique.variables) clique.size += graph_.sizeOf(v);
  clique.panel = pool_.take(clique.panelLength());
  update_matrices_.take(clique);
  clique.contribution = pool_.take(clique.separatorSize());
}

void Eliminator::release(Clique& clique) {
  pool_.give(clique.panel);
  update_matrices_.giveBack(clique);
  pool_.give(clique.contribution);
  clique.panel = clique.contribution = nullptr;
}

bool Eliminator::lift(VariableId v, std::span<const int> cliques) {
  if (!std::ranges::all_of(cliques, [&](int c) { return tree_[c].singular.empty(); })) return false;
  if (!tree_.putBehind(v, cliques.back())) return false;
  lift_.moveToEnd(cliques.front(), v);
  for (const int c : cliques) flops_ += liftCost(tree_[c], graph_.sizeOf(v)).flops;
  for (const int c : cliques.first(cliques.size() - 1)) {
    lift_.moveToParent(c);
    if (tree_[c].frontals == 0) dissolve(c);
  }
  return true;
}

/// Removes a clique that has no frontals left, and hangs its children below its parent.
void Eliminator::dissolve(int id) {
  const int parent = tree_[id].parent;
  for (const int orphan : remove(std::array{id}).orphans) attach(orphan, parent);
}

EliminationTree::Removed& Eliminator::remove(std::span<const int> cliques) {
  for (const int id : cliques) release(tree_[id]);
  return tree_.remove(cliques);
}

Eigen::MatrixXd Eliminator::marginal(std::span<const VariableId> eliminated, std::span<const VariableId> separator,
                                     std::span<const FactorId> factors) {
  Clique clique;
  clique.variables.assign(eliminated.begin(), eliminated.end());
  clique.variables.insert(clique.variables.end(), separator.begin(), separator.end());
  clique.factors.assign(factors.begin(), factors.end());
  clique.frontals = static_cast<int>(eliminated.size());
  layOut(clique);
  front_.eliminate(clique);
  release(clique);
  return front_.schurComplement();
}

void Eliminator::refresh(int id) {
  Clique& clique = tree_[id];
  update_matrices_.makeBelow(clique);
  update_matrices_.takeAgain(clique);
  weakest_pivot_ = std::min(weakest_pivot_, front_.eliminate(clique));
  update_matrices_.giveBackMadeAgainBelow(clique);
  const CliqueCost cost = eliminationCost(clique);
  eliminated_scalars_ += cost.scalars;
  flops_ += cost.flops;
}

void Eliminator::shiftRightHandSide(int id, std::span<double> change, std::span<double> parent_change) {
  Clique& clique = tree_[id];
  const int n = clique.frontal_size, rest = clique.separatorSize(), stride = clique.panelStride();
  // Computes d of the change alone, then adds it to the former d.
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
