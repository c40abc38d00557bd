#include "backend/solver/waiting_factors.hpp"

#include <algorithm>
#include <limits>

namespace motorcade {
namespace {

/// Work of a part with variables lifted through it, over that before, as found on long chains.
constexpr double kLiftedOverFormer = 1.25;

}  // namespace

int WaitingFactors::admit(std::vector<FactorId>& fresh, std::span<const VariableId> touched, bool settle) {
  allowance_ = std::max(budget_.left(), UpdateBudget::kLeast);
  marked_.reset(tree_.slots());
  counted_.reset(tree_.slots());
  held_.reset(graph_.slots());
  for (const VariableId v : touched)
    for (int c = tree_.cliqueOf(v); c >= 0 && marked_.insert(c); c = tree_[c].parent) {
    }
  if (budget_.limited()) admitFresh(fresh);
  const int admitted = settle ? 0 : admitWaiting(fresh);
  if (budget_.left() > 0) liftFirst();
  return admitted;
}

/// Cheap ones first: they hold the new variables.
void WaitingFactors::admitFresh(std::vector<FactorId>& fresh) {
  std::vector<std::pair<std::int64_t, FactorId>> by_cost;
  for (const FactorId f : fresh) by_cost.emplace_back(costOf(f), f);
  std::ranges::stable_sort(by_cost, {}, [](const auto& item) { return item.first; });
  puts_off_.reset(graph_.factorSlots());
  for (const auto& item : by_cost) {
    const FactorId f = item.second;
    const std::int64_t cost = costOf(f);
    if (cost <= allowance_ || !canWait(f)) {
      accept(f, cost);
    } else {
      puts_off_.insert(f.value);
      waiting_.push_back(f);
    }
  }
  std::erase_if(fresh, [&](FactorId f) { return puts_off_.contains(f.value); });
}

/// As far as the allowance reaches, and the ones above whose variables there is nothing to lift them through. The
/// number of them.
int WaitingFactors::admitWaiting(std::vector<FactorId>& fresh) {
  const std::size_t waited = waiting_.size();
  std::erase_if(waiting_, [&](FactorId f) {
    const std::int64_t cost = budget_.limited() ? costUpTo(f, allowance_) : 0;
    if (cost > allowance_ && findPath(f)) return false;
    accept(f, cost);
    graph_.linearize(f);  // at estimates that went on meanwhile
    fresh.push_back(f);
    return true;
  });
  return static_cast<int>(waited - waiting_.size());
}

std::vector<FactorId> WaitingFactors::takeWith(std::span<const VariableId> variables) {
  std::vector<FactorId> taken;
  std::erase_if(waiting_, [&](FactorId f) {
    const bool takes = std::ranges::any_of(graph_.factor(f).variables(),
                                           [&](VariableId v) { return std::ranges::count(variables, v) > 0; });
    if (takes) taken.push_back(f);
    return takes;
  });
  return taken;
}

double WaitingFactors::chi2() const {
  double sum = 0;
  std::vector<Value> values;
  std::vector<const Value*> pointers;
  for (const FactorId f : waiting_) {
    const Factor& factor = graph_.factor(f);
    values.clear(), pointers.clear();
    for (const VariableId v : factor.variables()) values.push_back(graph_.estimate(v));
    for (const Value& value : values) pointers.push_back(&value);
    Eigen::VectorXd r(factor.rows());
    factor.residual(pointers, r);
    sum += r.squaredNorm();
  }
  return sum;
}

/// Work on the cliques from the factor's variables up to the root, besides those that are eliminated in any case.
std::int64_t WaitingFactors::costOf(FactorId id) { return costUpTo(id, std::numeric_limits<std::int64_t>::max()); }

/// Not the whole when it is more than `most`.
std::int64_t WaitingFactors::costUpTo(FactorId id, std::int64_t most) {
  counted_.reset(tree_.slots());
  std::int64_t work = 0;
  for (const VariableId v : graph_.factor(id).variables())
    for (int c = tree_.cliqueOf(v); c >= 0 && work <= most && !marked_.contains(c) && counted_.insert(c);
         c = tree_[c].parent)
      work += tree_[c].eliminationWork();
  return work;
}

std::int64_t WaitingFactors::costAbove(VariableId v) {
  std::int64_t work = 0;
  for (int c = tree_.cliqueOf(v); c >= 0 && !marked_.contains(c); c = tree_[c].parent)
    work += tree_[c].eliminationWork();
  return work;
}

/// A factor with a residual; others hold its new variables, if it has any.
bool WaitingFactors::canWait(FactorId id) const {
  const Factor& factor = graph_.factor(id);
  return factor.form() == Factor::Form::kJacobian &&
         std::ranges::all_of(factor.variables(), [&](VariableId v) { return !isNew(v) || held_.contains(v.value); });
}

void WaitingFactors::accept(FactorId id, std::int64_t cost) {
  const Factor& factor = graph_.factor(id);
  allowance_ -= cost;
  if (cost > UpdateBudget::kLeast) budget_.spend(cost);
  for (const VariableId v : factor.variables()) {
    if (isNew(v) && factor.rows() >= graph_.sizeOf(v)) held_.insert(v.value);
    for (int c = tree_.cliqueOf(v); c >= 0 && marked_.insert(c); c = tree_[c].parent) {
    }
  }
}

/// The cliques above the one of the factor's variables from which it is farthest to the root, as far as the allowance
/// reaches. At least to the next clique, however large: that is progress. False when there is none.
bool WaitingFactors::findPath(FactorId id) {
  const auto variables = graph_.factor(id).variables();
  lifted_.assign(1, *std::ranges::max_element(variables, {}, [&](VariableId v) { return costAbove(v); }));
  cliques_.clear();
  double work = 0;
  for (int c = tree_.cliqueOf(lifted_.front()); c >= 0 && !marked_.contains(c); c = tree_[c].parent) {
    work += kLiftedOverFormer * static_cast<double>(tree_[c].eliminationWork());
    if (cliques_.size() >= 2 && work > static_cast<double>(allowance_)) break;
    cliques_.push_back(c);
  }
  return cliques_.size() >= 2;
}

/// Of the factors that wait, the first that costs more than the allowance comes nearer.
void WaitingFactors::liftFirst() {
  const auto far =
      std::ranges::find_if(waiting_, [&](FactorId f) { return costUpTo(f, allowance_) > allowance_ && findPath(f); });
  if (far == waiting_.end()) return;
  const std::int64_t before = tree_.eliminationWork();
  liftThroughPath();
  budget_.spend(tree_.eliminationWork() - before);
}

/// Eliminates the path anew, the variable as the last of it and before it those of other factors that wait. What R says
/// stays, and nothing above the path changes.
void WaitingFactors::liftThroughPath() {
  const int top = cliques_.back(), parent = tree_[top].parent;
  const auto separator = tree_[top].separator();
  boundary_.assign(separator.begin(), separator.end());
  part_.clear();
  tree_.remove(cliques_, part_);
  std::erase_if(part_.orphans, [&](int orphan) {
    const bool outside = std::ranges::none_of(tree_[orphan].separator(), [&](VariableId u) { return isNew(u); });
    if (outside) tree_.attach(orphan, parent);
    return outside;
  });
  collectLifted();
  created_.clear();
  tree_.eliminate({.order = lifted_order_(part_, boundary_, lifted_),
                   .boundary = boundary_,
                   .factors = part_.factors,
                   .orphans = part_.orphans,
                   .parent = parent,
                   .numbering = Elimination::Numbering::kBetween},
                  created_);
}

/// Beside the first one, the variables of waiting factors that are out of the tree with it.
void WaitingFactors::collectLifted() {
  std::ranges::sort(part_.variables);
  for (const FactorId f : waiting_)
    for (const VariableId v : graph_.factor(f).variables())
      if (std::ranges::binary_search(part_.variables, v) && std::ranges::count(lifted_, v) == 0) lifted_.push_back(v);
}

}  // namespace motorcade
