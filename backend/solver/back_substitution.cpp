#include "backend/solver/back_substitution.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "backend/elimination/dense_substitution.hpp"
#include "backend/graph/sort_unique.hpp"

namespace motorcade {

BackSubstitution::Result BackSubstitution::operator()(double threshold_sigmas, std::int64_t most_scalars) {
  result_ = {};
  moved_.clear();
  ++call_;
  moved_in_.resize(graph_.slots(), 0);
  waiting_since_.resize(graph_.slots(), 0);
  solveWork(threshold_sigmas);
  const std::int64_t with_work = result_.scalars;
  while (first_waiting_ < waiting_.size() && result_.scalars - with_work < most_scalars) {
    const VariableId v = waiting_[first_waiting_++];
    const Call since = std::exchange(waiting_since_[v.value], 0);
    if (since == 0 || tree_.cliqueOf(v) < 0) continue;  // it was solved since, or left the tree
    solve(tree_[tree_.cliqueOf(v)], since, threshold_sigmas);
  }
  if (2 * first_waiting_ >= waiting_.size()) {  // a deque would take memory and give it back
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(first_waiting_));
    first_waiting_ = 0;
  }
  result_.spread_scalars = result_.scalars - with_work;
  result_.moved = moved_;
  return result_;
}

/// Cliques with work hang together, from the roots downwards.
void BackSubstitution::solveWork(double threshold_sigmas) {
  open_.clear();
  for (const int root : tree_.roots())
    if (work_.has(root)) open_.push_back(root);
  while (!open_.empty()) {
    const Clique& clique = tree_[open_.back()];
    work_.finish(open_.back());
    open_.pop_back();
    Call since = call_;
    for (const VariableId v : clique.frontalVariables())
      if (waiting_since_[v.value] > 0) since = std::min(since, waiting_since_[v.value]);
    solve(clique, since, threshold_sigmas);
  }
}

void BackSubstitution::substitute(const Clique& clique, std::vector<double>& x_separator,
                                  std::vector<double>& x_frontal) const {
  x_separator.clear();
  for (const VariableId v : clique.separator()) {
    const auto& x = graph_[v].x;
    x_separator.insert(x_separator.end(), x.begin(), x.begin() + graph_.sizeOf(v));
  }
  x_frontal.resize(clique.frontal_size);
  backSubstitute(clique.panelView(), x_separator.data(), x_frontal.data());
}

void BackSubstitution::solve(const Clique& clique, Call since, double threshold_sigmas) {
  substitute(clique, x_separator_, x_frontal_);
  result_.scalars += clique.frontal_size;
  moveVariables(clique, threshold_sigmas);
  for (int child = clique.first_child; child >= 0; child = tree_[child].next_sibling) {
    const bool moved =
        std::ranges::any_of(tree_[child].separator(), [&](VariableId v) { return moved_in_[v.value] >= since; });
    if (moved) putOff(tree_[child], since);
    if (work_.has(child)) open_.push_back(child);
  }
}

void BackSubstitution::putOff(const Clique& clique, Call since) {
  for (const VariableId v : clique.frontalVariables()) {
    Call& waiting_since = waiting_since_[v.value];
    if (waiting_since == 0) waiting_.push_back(v);
    waiting_since = waiting_since == 0 ? since : std::min(waiting_since, since);
  }
}

std::int64_t BackSubstitution::waitingScalars() const {
  std::int64_t scalars = 0;
  for (const VariableId v : std::span(waiting_).subspan(first_waiting_))
    if (waiting_since_[v.value] > 0 && tree_.cliqueOf(v) >= 0) scalars += graph_.sizeOf(v);
  return scalars;
}

/// Of |R x + S x_separator + d|^2 of the cliques, which vanishes at their solutions.
double BackSubstitution::waitingChi2() const {
  std::vector<int> cliques;
  for (const VariableId v : std::span(waiting_).subspan(first_waiting_))
    if (waiting_since_[v.value] > 0 && tree_.cliqueOf(v) >= 0) cliques.push_back(tree_.cliqueOf(v));
  sortUnique(cliques);
  double sum = 0;
  std::vector<double> x_separator, step;
  for (const int c : cliques) {
    substitute(tree_[c], x_separator, step);
    std::size_t at = 0;
    for (const VariableId v : tree_[c].frontalVariables())
      for (int i = 0; i < graph_.sizeOf(v); ++i, ++at) step[at] -= graph_[v].x[i];
    const auto R_transposed = tree_[c].factor();
    for (int row = 0; row < tree_[c].frontal_size; ++row) {
      double residual = 0;
      for (int i = row; i < tree_[c].frontal_size; ++i) residual += R_transposed(i, row) * step[i];
      sum += residual * residual;
    }
  }
  return sum;
}

/// Takes over the new x.
void BackSubstitution::moveVariables(const Clique& clique, double threshold_sigmas) {
  std::size_t at = 0;
  for (const VariableId v : clique.frontalVariables()) {
    auto& variable = graph_[v];
    waiting_since_[v.value] = 0;
    double change = 0, sigmas_squared = 0;
    for (int i = 0; i < variable.size; ++i, ++at) {
      change = std::max(change, std::abs(x_frontal_[at] - variable.x[i]));
      const double step = x_frontal_[at] - variable.x_spread[i];
      sigmas_squared = std::max(sigmas_squared, step * step * variable.information[i]);
      variable.x[i] = x_frontal_[at];
    }
    result_.largest_change = std::max(result_.largest_change, change);
    if (sigmas_squared <= threshold_sigmas * threshold_sigmas) continue;
    variable.x_spread = variable.x;
    moved_in_[v.value] = call_;
    moved_.push_back(v);
  }
}

}  // namespace motorcade
