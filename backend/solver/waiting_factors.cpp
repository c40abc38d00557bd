#include "backend/solver/waiting_factors.hpp"

#include <algorithm>

namespace motorcade {
namespace {

/// Scalars through which a variable is lifted at once. Between several steps one can see whether there is time left.
constexpr std::int64_t kLiftedAtOnce = 2000;

}  // namespace

void WaitingFactors::admit(std::vector<FactorId>& fresh, std::span<const VariableId> touched) {
  allowance_ = std::max(budget_.left(), EliminationBudget::kLeast);
  marked_.reset(tree_.slots());
  counted_.reset(tree_.slots());
  held_.reset(graph_.slots());
  for (const VariableId v : touched)
    for (int c = tree_.cliqueOf(v); c >= 0 && marked_.insert(c); c = tree_[c].parent) {
    }
  if (budget_.limited()) admitFresh(fresh);
  admitWaiting(fresh);
}

/// Admits new factors, cheap ones first, as they hold the new variables.
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

/// Admits waiting factors as far as the allowance reaches; then the first one that it does not reach comes nearer.
void WaitingFactors::admitWaiting(std::vector<FactorId>& fresh) {
  std::erase_if(waiting_, [&](FactorId f) {
    const std::int64_t cost = budget_.limited() ? costOf(f) : 0;
    if (cost > allowance_) return false;
    accept(f, cost);
    graph_.models().linearize(f);  // at estimates that went on meanwhile
    fresh.push_back(f);
    return true;
  });
  if (waiting_.empty()) return;
  if (!liftVariableOf(waiting_.front())) {  // there is nothing above to lift through
    fresh.push_back(waiting_.front());
    graph_.models().linearize(waiting_.front());
    waiting_.erase(waiting_.begin());
    return;
  }
  while (allowance_ > EliminationBudget::kLeast && !budget_.timeForEliminationsIsOver() &&
         liftVariableOf(waiting_.front())) {
  }
}

std::vector<FactorId> WaitingFactors::takeWith(std::span<const VariableId> variables) {
  std::vector<FactorId> taken;
  std::erase_if(waiting_, [&](FactorId f) {
    const bool takes =
        std::ranges::any_of(graph_.variablesOf(f), [&](VariableId v) { return std::ranges::count(variables, v) > 0; });
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
    const JacobianFactor& factor = *graph_.models().jacobianFactor(f);
    values.clear(), pointers.clear();
    for (const VariableId v : factor.variables()) values.push_back(graph_.states().estimate(v));
    for (const Value& value : values) pointers.push_back(&value);
    Eigen::VectorXd r(factor.rows());
    factor.residual(pointers, r);
    sum += r.squaredNorm();
  }
  return sum;
}

/// Scalars of the cliques from the factor's variables up to the root, without those that are eliminated in any case.
std::int64_t WaitingFactors::costOf(FactorId id) {
  counted_.reset(tree_.slots());
  std::int64_t scalars = 0;
  for (const VariableId v : graph_.variablesOf(id))
    for (int c = tree_.cliqueOf(v); c >= 0 && !marked_.contains(c) && counted_.insert(c); c = tree_[c].parent)
      scalars += tree_[c].frontal_size;
  return scalars;
}

std::int64_t WaitingFactors::costAbove(VariableId v) {
  std::int64_t scalars = 0;
  for (int c = tree_.cliqueOf(v); c >= 0 && !marked_.contains(c); c = tree_[c].parent) scalars += tree_[c].frontal_size;
  return scalars;
}

/// True for a factor with a residual whose new variables, if it has any, are held by others.
bool WaitingFactors::canWait(FactorId id) const {
  return graph_.models().isJacobian(id) && std::ranges::all_of(graph_.variablesOf(id), [&](VariableId v) {
           return !isNew(v) || held_.contains(v.value);
         });
}

void WaitingFactors::accept(FactorId id, std::int64_t cost) {
  const int rows = graph_.models().factor(id).rows();
  allowance_ -= cost;
  if (cost > EliminationBudget::kLeast) budget_.spend(cost);
  for (const VariableId v : graph_.variablesOf(id)) {
    if (isNew(v) && rows >= graph_.sizeOf(v)) held_.insert(v.value);
    for (int c = tree_.cliqueOf(v); c >= 0 && marked_.insert(c); c = tree_[c].parent) {
    }
  }
}

/// Lifts the variable that is farthest from the root, at least to the next clique, however large: that is progress.
bool WaitingFactors::liftVariableOf(FactorId id) {
  const auto variables = graph_.variablesOf(id);
  const VariableId v = *std::ranges::max_element(variables, {}, [&](VariableId u) { return costAbove(u); });
  std::vector<int> cliques;
  std::int64_t scalars = 0;
  for (int c = tree_.cliqueOf(v); c >= 0 && !marked_.contains(c); c = tree_[c].parent) {
    if (cliques.size() >= 2 && scalars + tree_[c].frontal_size > std::min(allowance_, kLiftedAtOnce)) break;
    cliques.push_back(c);
    scalars += tree_[c].frontal_size;
  }
  if (cliques.size() < 2 || !eliminator_.lift(v, cliques)) return false;
  budget_.spend(scalars);
  allowance_ -= scalars;
  return true;
}

}  // namespace motorcade
