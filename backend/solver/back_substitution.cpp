#include "backend/solver/back_substitution.hpp"

#include <algorithm>
#include <cmath>

#include "backend/elimination/dense_substitution.hpp"

namespace motorcade {

BackSubstitution::Result BackSubstitution::operator()(double threshold_sigmas, std::int64_t most_scalars) {
  result_ = {};
  moved_.clear();
  has_moved_.reset(graph_.slots());
  is_waiting_.resize(tree_.slots(), 0);
  solveWork(threshold_sigmas);
  const std::int64_t with_work = result_.scalars;
  while (!waiting_.empty() && (most_scalars == 0 || result_.scalars - with_work < most_scalars)) {
    const int id = waiting_.front();
    waiting_.pop_front();
    const bool is_due = is_waiting_[id] && tree_[id].alive;  // or it was solved since, or left the tree
    is_waiting_[id] = 0;
    if (is_due) solve(id, threshold_sigmas);
  }
  result_.moved = moved_;
  return result_;
}

/// Cliques with work hang together, from the roots downwards.
void BackSubstitution::solveWork(double threshold_sigmas) {
  open_.clear();
  for (const int root : tree_.roots())
    if (work_.has(root)) open_.push_back(root);
  while (!open_.empty()) {
    const int id = open_.back();
    open_.pop_back();
    work_.finish(id);
    solve(id, threshold_sigmas);
  }
}

void BackSubstitution::solve(int id, double threshold_sigmas) {
  const Clique& clique = tree_[id];
  is_waiting_[id] = 0;
  x_separator_.clear();
  for (const VariableId v : clique.separator()) {
    const auto& x = graph_[v].x;
    x_separator_.insert(x_separator_.end(), x.begin(), x.begin() + graph_.sizeOf(v));
  }
  x_frontal_.resize(clique.frontal_size);
  backSubstitute(clique.panelView(), x_separator_.data(), x_frontal_.data());
  result_.scalars += clique.frontal_size;
  moveVariables(clique, threshold_sigmas);
  for (int child = clique.first_child; child >= 0; child = tree_[child].next_sibling) {
    if (work_.has(child)) {
      open_.push_back(child);
    } else if (!is_waiting_[child] && isBelowMoved(child)) {
      waiting_.push_back(child);
      is_waiting_[child] = 1;
    }
  }
}

bool BackSubstitution::isBelowMoved(int clique) const {
  return std::ranges::any_of(tree_[clique].separator(), [&](VariableId v) { return has_moved_.contains(v.value); });
}

/// Takes over the new x.
void BackSubstitution::moveVariables(const Clique& clique, double threshold_sigmas) {
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
    result_.largest_change = std::max(result_.largest_change, change);
    if (sigmas_squared <= threshold_sigmas * threshold_sigmas) continue;
    variable.x_spread = variable.x;
    has_moved_.insert(v.value);
    moved_.push_back(v);
  }
}

}  // namespace motorcade
