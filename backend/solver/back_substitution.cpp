#include "backend/solver/back_substitution.hpp"

#include <algorithm>
#include <cmath>

#include "backend/elimination/dense_substitution.hpp"

namespace motorcade {

BackSubstitution::Result BackSubstitution::operator()(double threshold_sigmas) {
  result_ = {};
  moved_.clear();
  has_moved_.reset(graph_.slots());
  open_.clear();
  for (const int root : tree_.roots())
    if (work_.has(root)) open_.push_back(root);
  while (!open_.empty()) {
    const int id = open_.back();
    const Clique& clique = tree_[id];
    open_.pop_back();
    work_.finish(id);
    solve(clique, threshold_sigmas);
    for (int child = clique.first_child; child >= 0; child = tree_[child].next_sibling) {
      const bool changed = work_.has(child) || std::ranges::any_of(tree_[child].separator(), [&](VariableId v) {
                             return has_moved_.contains(v.value);
                           });
      if (changed) open_.push_back(child);
    }
  }
  result_.moved = moved_;
  return result_;
}

void BackSubstitution::solve(const Clique& clique, double threshold_sigmas) {
  x_separator_.clear();
  for (const VariableId v : clique.separator()) {
    const auto& x = graph_[v].x;
    x_separator_.insert(x_separator_.end(), x.begin(), x.begin() + graph_.sizeOf(v));
  }
  x_frontal_.resize(clique.frontal_size);
  backSubstitute(clique.panelView(), x_separator_.data(), x_frontal_.data());
  result_.scalars += clique.frontal_size;
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
