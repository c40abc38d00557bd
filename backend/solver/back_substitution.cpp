#include "backend/solver/back_substitution.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "backend/elimination/dense_substitution.hpp"

namespace motorcade {
namespace {

constexpr double kFar = 4;  // thresholds beyond which a variable has moved far

}  // namespace

BackSubstitution::Result BackSubstitution::operator()(double threshold_sigmas, std::int64_t most_scalars,
                                                      Spread spread) {
  result_ = {};
  moved_.clear();
  solved_.clear();
  hurrying_.clear();
  first_of_call_ = newest_ + 1;
  spread_ = spread;
  waiting_since_.resize(graph_.slots(), 0);
  solved_by_.resize(graph_.slots(), 0);
  moved_by_.resize(graph_.slots(), 0);
  moved_far_by_.resize(graph_.slots(), 0);
  solveWork(threshold_sigmas);
  const std::int64_t with_work = result_.scalars;
  const auto mayGoOn = [&] {
    const std::int64_t done = result_.scalars - with_work;
    return done < most_scalars && hasTime();
  };
  if (spread == Spread::kAll)
    while (first_waiting_ < waiting_.size() && mayGoOn()) {
      fetchWaiting();
      solveWaiting(waiting_[first_waiting_++], threshold_sigmas);
    }
  else
    for (std::size_t i = 0; i < hurrying_.size() && mayGoOn(); ++i) solveWaiting(hurrying_[i], threshold_sigmas);
  if (2 * first_waiting_ >= waiting_.size()) {  // a deque would take memory and give it back
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(first_waiting_));
    first_waiting_ = 0;
  }
  result_.moved = moved_;
  result_.solved = solved_;
  return result_;
}

/// Asks for what the next cliques will read first; the processor finds by itself what lies behind.
void BackSubstitution::fetchWaiting() const {
  constexpr std::size_t kSoon = 6, kLater = 12;  // variables; a clique has a few
  constexpr int kLine_bytes = 64, kPanelLines = 8;
  const auto fetch = [](const void* from, int lines) {
    for (int line = 0; line < lines; ++line) __builtin_prefetch(static_cast<const char*>(from) + line * kLine_bytes);
  };
  const auto cliqueAt = [&](std::size_t ahead) {
    const std::size_t at = first_waiting_ + ahead;
    return at < waiting_.size() ? tree_.cliqueOf(waiting_[at]) : -1;
  };
  if (const int later = cliqueAt(kLater); later >= 0) fetch(&tree_[later], sizeof(Clique) / kLine_bytes);
  if (const int soon = cliqueAt(kSoon); soon >= 0) {
    fetch(tree_[soon].variables.data(), 1);
    fetch(tree_[soon].panel, kPanelLines);
  }
}

void BackSubstitution::solveWaiting(VariableId v, double threshold_sigmas) {
  const Solution since = std::exchange(waiting_since_[v.value], 0);
  if (since == 0 || tree_.cliqueOf(v) < 0) return;  // it was solved since, or left the tree
  solve(tree_[tree_.cliqueOf(v)], since, threshold_sigmas);
}

/// Solves the cliques with work, which hang together from the roots downwards. Without time left, those farther down
/// wait like others.
void BackSubstitution::solveWork(double threshold_sigmas) {
  open_.clear();
  for (const int root : tree_.roots())
    if (work_.has(root)) open_.push_back(root);
  while (!open_.empty()) {
    const Clique& clique = tree_[open_.back()];
    work_.finish(open_.back());
    open_.pop_back();
    Solution since = first_of_call_;
    for (const VariableId v : clique.frontalVariables())
      if (waiting_since_[v.value] > 0) since = std::min(since, waiting_since_[v.value]);
    if (result_.scalars < EliminationBudget::kLeast.scalars || !budget_.isOver()) {
      solve(clique, since, threshold_sigmas);
      continue;
    }
    putOff(clique, since);
    for (int child = clique.first_child; child >= 0; child = tree_[child].next_sibling)
      if (work_.has(child)) open_.push_back(child);
  }
}

void BackSubstitution::solve(const Clique& clique, Solution since, double threshold_sigmas) {
  ++newest_;
  solved_.push_back(tree_.cliqueOf(clique.frontalVariables().front()));
  x_separator_.resize(std::max(x_separator_.size(), std::size_t(clique.size) + VariableState::kMaxDimension));
  double* end = x_separator_.data();
  for (const VariableId v : clique.separator()) {
    const VariableState& state = graph_.states()[v];
    __builtin_memcpy(end, state.x.data(), sizeof(state.x));  // so many numbers are copied without a call
    end += state.size;
  }
  x_frontal_.resize(std::max(x_frontal_.size(), std::size_t(clique.frontal_size)));
  backSubstitute(clique.panelView(), x_separator_.data(), x_frontal_.data());
  result_.scalars += clique.frontal_size;
  budget_.count(substitutionFlops(clique));
  moveVariables(clique, threshold_sigmas);
  for (int child = clique.first_child; child >= 0; child = tree_[child].next_sibling) {
    const auto anyIn = [&](const std::vector<Solution>& by) {
      return std::ranges::any_of(tree_[child].separator(), [&](VariableId v) { return by[v.value] >= since; });
    };
    if (anyIn(moved_by_)) putOff(tree_[child], since);
    if (spread_ == Spread::kFar && anyIn(moved_far_by_)) hurrying_.push_back(tree_[child].variables.front());
    if (work_.has(child)) open_.push_back(child);
  }
}

void BackSubstitution::putOff(const Clique& clique, Solution since) {
  for (const VariableId v : clique.frontalVariables()) {
    Solution& waiting_since = waiting_since_[v.value];
    if (waiting_since == 0) waiting_.push_back(v);
    waiting_since = waiting_since == 0 ? since : std::min(waiting_since, since);
  }
}

bool BackSubstitution::hasTime() const {
  return result_.scalars < EliminationBudget::kLeast.scalars || !budget_.isOverForSubstitution();
}

bool BackSubstitution::hasFollowed(FactorId factor) const {
  if (first_waiting_ == waiting_.size()) return true;  // no clique waits
  const auto variables = graph_.variablesOf(factor);
  const VariableId last = tree_[tree_.ownerOf(variables)].frontalVariables().front();
  return std::ranges::all_of(variables, [&](VariableId v) { return moved_by_[v.value] <= solved_by_[last.value]; });
}

std::int64_t BackSubstitution::waitingScalars() const {
  std::int64_t scalars = 0;
  for (const VariableId v : std::span(waiting_).subspan(first_waiting_))
    if (waiting_since_[v.value] > 0 && tree_.cliqueOf(v) >= 0) scalars += graph_.sizeOf(v);
  return scalars;
}

/// Takes over the new x.
void BackSubstitution::moveVariables(const Clique& clique, double threshold_sigmas) {
  std::size_t at = 0;
  for (const VariableId v : clique.frontalVariables()) {
    auto& variable = graph_.states()[v];
    waiting_since_[v.value] = 0;
    solved_by_[v.value] = newest_;
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
    moved_by_[v.value] = newest_;
    if (sigmas_squared > kFar * kFar * threshold_sigmas * threshold_sigmas) moved_far_by_[v.value] = newest_;
    moved_.push_back(v);
  }
}

}  // namespace motorcade
