#include "backend/solver/waiting_factors.hpp"

#include <algorithm>

namespace motorcade {
namespace {

/// Scalars through which a variable is lifted at once. Between several steps one can see whether there is time left.
constexpr std::int64_t kLiftedAtOnce = 2000;
constexpr std::size_t kLeastLifted = 2;  // cliques: from one to the next
/// Flops of an elimination in a new order over those in the former one: the newest variables last make some fill.
constexpr double kFillOfNewOrder = 1.5;

}  // namespace

void WaitingFactors::admit(std::vector<FactorId>& fresh, std::span<const VariableId> touched, bool corrections_first) {
  marked_.reset(tree_.slots());
  counted_.reset(tree_.slots());
  held_.reset(graph_.slots());
  for (const VariableId v : touched) mark(v);
  allowance_ = {std::max(budget_.left().scalars, EliminationBudget::kLeast.scalars),
                std::max(budget_.left().flops, EliminationBudget::kLeast.flops)};
  if (budget_.limited()) admitFresh(fresh);
  if (!corrections_first) admitWaiting(fresh);
}

/// Admits new factors, cheap ones first, as they hold the new variables.
void WaitingFactors::admitFresh(std::vector<FactorId>& fresh) {
  std::vector<std::pair<double, FactorId>> by_cost;
  for (const FactorId f : fresh) by_cost.emplace_back(costOf(f).flops, f);
  std::ranges::stable_sort(by_cost, {}, [](const auto& item) { return item.first; });
  puts_off_.reset(graph_.factorSlots());
  for (const auto& item : by_cost) {
    const FactorId f = item.second;
    const CliqueCost cost = costOf(f);
    if (allows(cost) || !canWait(f)) {
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
  std::erase_if(waiting_, [&](FactorId f) { return admit(f, budget_.limited() ? costOf(f) : CliqueCost{}, fresh); });
  const auto isLeft = [&] {
    return allowance_.scalars > EliminationBudget::kLeast.scalars &&
           allowance_.flops > EliminationBudget::kLeast.flops && !budget_.isOverForEliminations();
  };
  for (bool lifted_any = false; !waiting_.empty() && (!lifted_any || isLeft()); lifted_any = true) {
    const FactorId first = waiting_.front();
    const Lift lift = liftVariableOf(first, lifted_any ? 0 : kLeastLifted);
    if (lift == Lift::kBeyondAllowance) break;
    if (admit(first, lift == Lift::kDone ? costOf(first) : CliqueCost{}, fresh)) waiting_.erase(waiting_.begin());
  }
}

/// Lets a factor that waited in if it does not cost too much; linearizes it at estimates that went on meanwhile.
bool WaitingFactors::admit(FactorId id, const CliqueCost& cost, std::vector<FactorId>& fresh) {
  if (!allows(cost)) return false;
  accept(id, cost);
  graph_.models().linearize(id);
  fresh.push_back(id);
  return true;
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

/// Cost of the cliques from the factor's variables up to the root, without those that are eliminated in any case.
CliqueCost WaitingFactors::costOf(FactorId id) {
  counted_.reset(tree_.slots());
  CliqueCost cost;
  for (const VariableId v : graph_.variablesOf(id))
    for (int c = tree_.cliqueOf(v); c >= 0 && !marked_.contains(c) && counted_.insert(c); c = tree_[c].parent)
      cost += eliminationCost(tree_[c]);
  cost.flops *= kFillOfNewOrder;
  return cost;
}

std::int64_t WaitingFactors::scalarsAbove(VariableId v) const {
  std::int64_t scalars = 0;
  for (int c = tree_.cliqueOf(v); c >= 0 && !marked_.contains(c); c = tree_[c].parent) scalars += tree_[c].frontal_size;
  return scalars;
}

/// Marks the cliques that a factor on the variable has eliminated anew.
void WaitingFactors::mark(VariableId v) {
  for (int c = tree_.cliqueOf(v); c >= 0 && marked_.insert(c); c = tree_[c].parent) {
  }
}

/// True for a factor with a residual whose new variables, if it has any, are held by others.
bool WaitingFactors::canWait(FactorId id) const {
  return graph_.models().isJacobian(id) && std::ranges::all_of(graph_.variablesOf(id), [&](VariableId v) {
           return !isNew(v) || held_.contains(v.value);
         });
}

void WaitingFactors::accept(FactorId id, const CliqueCost& cost) {
  const int rows = graph_.models().factor(id).rows();
  allowance_.scalars -= cost.scalars;
  allowance_.flops -= cost.flops;
  budget_.plan({cost.scalars > EliminationBudget::kLeast.scalars ? cost.scalars : 0, cost.flops});
  for (const VariableId v : graph_.variablesOf(id)) {
    if (isNew(v) && rows >= graph_.sizeOf(v)) held_.insert(v.value);
    mark(v);
  }
}

/// Lifts the variable that is farthest from the root, through `least` cliques however large they are: that is progress.
/// The first clique that is eliminated anew in any case is the goal: there the factor costs nothing.
WaitingFactors::Lift WaitingFactors::liftVariableOf(FactorId id, std::size_t least) {
  const auto variables = graph_.variablesOf(id);
  const VariableId v = *std::ranges::max_element(variables, {}, [&](VariableId u) { return scalarsAbove(u); });
  std::vector<int> cliques;
  CliqueCost cost;
  bool ends = true;
  for (int c = tree_.cliqueOf(v); c >= 0; c = tree_[c].parent) {
    const bool at_goal = marked_.contains(c);
    CliqueCost with = cost;
    with += liftCost(tree_[c], graph_.sizeOf(v));
    if (at_goal) with.scalars = cost.scalars;
    ends = !allows(with) || (cliques.size() >= kLeastLifted && with.scalars > kLiftedAtOnce);
    if (ends && cliques.size() >= least) break;
    cliques.push_back(c);
    cost = with;
    if (at_goal) break;
  }
  if (ends && cliques.size() < kLeastLifted && least < kLeastLifted) return Lift::kBeyondAllowance;
  if (cliques.size() < kLeastLifted || !eliminator_.lift(v, cliques)) return Lift::kNone;
  budget_.spend(cost);
  allowance_.scalars -= cost.scalars;
  allowance_.flops -= cost.flops;
  return Lift::kDone;
}

}  // namespace motorcade
