#include "backend/solver/fluid_relinearization.hpp"

#include <algorithm>
#include <cmath>

namespace motorcade {
namespace {

/// Share of the urgent turn at which variables with a drifted Jacobian are marked: it is urgent however little they
/// turned.
constexpr double kDriftedShare = 1.0001;
/// Share of the worst variable's turn above which connected variables are relinearized with it.
constexpr double kTurnedWithShare = 0.1;
constexpr double kLeastStaleness_rad = 1e-12;  // tells a stale variable that has not turned from one that is not stale
/// Stale variables are sorted a few at a time, as the budget seldom reaches farther; and a region has to end somewhere.
constexpr std::ptrdiff_t kWorstAtOnce = 16;
constexpr std::size_t kLargestRegion = 1000;
constexpr int kLookedAtAtRest = 16;
/// Drifts, in those at which Jacobians are taken anew, up to which residuals are still corrected.
constexpr double kTrustedDrifts = 4;
constexpr std::size_t kLeastLookedAt = 128;  // variables that moved, in a step
constexpr std::size_t kAhead = 4;            // of them, asked for before they are looked at
constexpr std::size_t kMostPutOff = 32;      // residuals that a step follows towards the root in vain

/// First row of a variable in a clique's front.
int firstRowOf(VariableId v, const Clique& clique, const FactorGraph& graph) {
  int row = 0;
  for (const VariableId u : clique.variables) {
    if (u == v) break;
    row += graph.sizeOf(u);
  }
  return row;
}

/// True for a vector in a quadratic, whose term stays right wherever the vector goes. A vector may be in very many of
/// them, as an offset that all measurements share is.
bool entersLinearly(VariableId v, FactorId factor, const FactorGraph& graph) {
  return graph.states().isVector(v) && !graph.models().isJacobian(factor);
}

}  // namespace

void FluidRelinearization::compareModels(const BackSubstitution::Result& step) {
  compared_.reset(graph_.factorSlots());
  half_followed_.resize(graph_.factorSlots(), 0);
  staleness_rad_.resize(graph_.slots(), 0.0);
  tolerance_ = params_.mismatch_tolerance * models_.rmsResidual();
  compareThoseThatFollowed(step.solved);
  to_look_at_.insert(to_look_at_.end(), step.moved.begin(), step.moved.end());
  std::size_t seen = 0;
  for (; seen < to_look_at_.size() && (seen < kLeastLookedAt || !budget_.isOver()); ++seen) {
    if (seen + kAhead < to_look_at_.size()) states_.fetch(to_look_at_[seen + kAhead]);
    if (graph_.contains(to_look_at_[seen])) lookAt(to_look_at_[seen]);
  }
  to_look_at_.erase(to_look_at_.begin(), to_look_at_.begin() + static_cast<std::ptrdiff_t>(seen));
}

/// Compares models that waited for their variables to follow a step. Estimates that followed it halfway are bent where
/// the step ends, and models corrected or linearized there would fit an estimate that nobody asked for. The last of a
/// factor's variables to follow is in the clique that the factor belongs to.
void FluidRelinearization::compareThoseThatFollowed(std::span<const int> solved) {
  for (const int clique : solved)
    for (const FactorId f : tree_[clique].factors) {
      if (!half_followed_[f.value] || !substitution_.hasFollowed(f)) continue;
      half_followed_[f.value] = 0;
      for (const VariableId v : graph_.variablesOf(f))
        if (const double turn = states_.turnSinceLinearization(v); turn > params_.leisurely_rad) markStale(v, turn);
      if (compared_.insert(f.value)) compare(f);
    }
}

/// Compares the models of a variable that moved, or leaves them until they have followed.
void FluidRelinearization::lookAt(VariableId v) {
  const double turn = states_.turnSinceLinearization(v);
  const bool stale = turn > params_.leisurely_rad,
             far = states_.mismatchBound(v) >= params_.compared_share * tolerance_;
  if (!stale && !far) return;
  if (far) {
    states_.markCompared(v);
    for (const FactorId f : graph_.factorsOf(v)) models_.fetch(f);
  }
  bool followed = true;
  for (const FactorId f : graph_.factorsOf(v)) {
    if (models_.isProvisional(f) || entersLinearly(v, f, graph_)) continue;
    if (outside_tree_.contains(f.value)) continue;
    if (!substitution_.hasFollowed(f)) {
      followed = false;
      half_followed_[f.value] = 1;
    } else if (far && compared_.insert(f.value)) {
      compare(f);
    }
  }
  if (stale && followed) markStale(v, turn);
}

void FluidRelinearization::compare(FactorId f) {
  if (const double norm = models_.mismatch(f).norm; norm > tolerance_) off_.push_back({f, norm});
}

/// Marks a variable whose factors need new Jacobians; `turn_rad` says how urgently.
void FluidRelinearization::markStale(VariableId v, double turn_rad) {
  double& staleness = staleness_rad_[v.value];
  if (staleness == 0) stale_.push_back(v);
  staleness = std::max(staleness, std::max(turn_rad, kLeastStaleness_rad));
}

void FluidRelinearization::beginStep(std::span<const FactorId> new_factors, std::span<const FactorId> waiting) {
  new_factors_.reset(graph_.factorSlots());
  half_followed_.resize(graph_.factorSlots(), 0);
  for (const FactorId f : new_factors) half_followed_[f.value] = 0;  // it may have the id of one that left
  for (const auto& absent : {new_factors, waiting})
    for (const FactorId f : absent) new_factors_.insert(f.value);
  outside_tree_.reset(graph_.factorSlots());
  for (const FactorId f : waiting) outside_tree_.insert(f.value);
  // A new factor may have taken the id of one that left.
  std::erase_if(off_, [&](const OffModel& off) {
    return !graph_.contains(off.factor) || new_factors_.contains(off.factor.value);
  });
}

FluidRelinearization::Corrections FluidRelinearization::correctModels(bool in_any_case) {
  corrections_ = {};
  corrects_in_any_case_ = in_any_case;
  relinearized_.clear();
  is_relinearized_.reset(graph_.factorSlots());
  staleness_rad_.resize(graph_.slots(), 0.0);
  markDrifted();
  relinearizeStale();
  for (const FactorId f : relinearized_) models_.linearize(f);
  corrections_.relinearized_factors = static_cast<int>(relinearized_.size());
  correctResiduals();
  return corrections_;
}

/// Corrects residuals as far as the budget reaches; the others go to the end of the list. As finding them takes time,
/// too, the search ends after kMostPutOff of them.
void FluidRelinearization::correctResiduals() {
  corrected_.reset(graph_.factorSlots());
  std::vector<OffModel> put_off;
  std::size_t seen = 0;
  for (; seen < off_.size() && put_off.size() < kMostPutOff; ++seen) {
    const OffModel& off = off_[seen];
    if (is_relinearized_.contains(off.factor.value) || corrected_.contains(off.factor.value)) continue;
    if (!substitution_.hasFollowed(off.factor)) {
      half_followed_[off.factor.value] = 1;
      continue;
    }
    if (waitsForJacobians(off)) continue;
    if (!reachesResidual(off.factor)) {
      put_off.push_back(off);
      continue;
    }
    corrected_.insert(off.factor.value);
    correctResidual(off.factor);
  }
  off_.erase(off_.begin(), off_.begin() + static_cast<std::ptrdiff_t>(seen));
  off_.insert(off_.end(), put_off.begin(), put_off.end());
  std::erase_if(off_, [&](const OffModel& off) { return !corrected_.insert(off.factor.value); });  // once each
  budget_.saveSubstitutions(!off_.empty());
  corrections_wait_ = !put_off.empty();
}

/// True for a model that is off too far to be corrected before its Jacobian, which the budget puts off. Such a model
/// makes steps overshoot, and corrections of that would grow without bound. Left as it is, the problem has a solution.
bool FluidRelinearization::waitsForJacobians(const OffModel& off) const {
  return budget_.limited() && models_.drift(off.factor) + off.mismatch > kTrustedDrifts * params_.jacobian_drift_sigmas;
}

/// Spends the substitutions that carry a new right-hand side from the model's clique to the root.
bool FluidRelinearization::reachesResidual(FactorId id) {
  if (!budget_.limited()) return true;
  std::int64_t scalars = 0;
  double flops = 0;
  for (int c = tree_.ownerOf(graph_.variablesOf(id)); c >= 0 && !work_.has(c); c = tree_[c].parent) {
    scalars += tree_[c].frontal_size;
    flops += substitutionFlops(tree_[c]);
    if (!budget_.affordsSubstitution(scalars, flops) && !corrects_in_any_case_) return false;
  }
  budget_.spendSubstitutions(scalars);
  budget_.count(flops);
  corrects_in_any_case_ = false;
  return true;
}

void FluidRelinearization::clear() {
  off_.clear();
  std::ranges::fill(half_followed_, 0);
  to_look_at_.clear();
  for (const VariableId v : stale_) staleness_rad_[v.value] = 0;
  stale_.clear();
}

/// Marks the variables of factors whose Jacobians drifted as stale.
void FluidRelinearization::markDrifted() {
  for (const OffModel& off : off_) {
    if (models_.drift(off.factor) + off.mismatch <= params_.jacobian_drift_sigmas) continue;
    for (const VariableId v : graph_.variablesOf(off.factor))
      if (!entersLinearly(v, off.factor, graph_))
        markStale(v, std::max(kDriftedShare * params_.relinearize_rad, states_.turnSinceLinearization(v)));
  }
}

/// Relinearizes stale variables within the budget. What is left of it is saved while the worst variable costs more.
void FluidRelinearization::relinearizeStale() {
  relinearizeWhatIsFree();
  std::erase_if(stale_, [&](VariableId v) {
    if (!graph_.contains(v)) staleness_rad_[v.value] = 0;  // its id may be given out again
    return !isStale(v);
  });
  const Reach reach = relinearizeWorst();
  if (std::isfinite(params_.polish_flops)) relinearizeAtRest();
  std::erase_if(stale_, [&](VariableId v) { return !isStale(v); });
  budget_.save(reach == Reach::kBeyondBudget);
}

/// Relinearizes stale variables whose cliques are eliminated anew in any case.
void FluidRelinearization::relinearizeWhatIsFree() {
  for (const int c : work_.removed())
    for (const VariableId v : tree_[c].frontalVariables())
      if (isStale(v) && isFree(v)) relinearize(v);
}

/// Relinearizes the worst first, as far as the allowances reach. Variables so far off that the solution suffers have
/// one allowance; the others, which can wait, have another.
FluidRelinearization::Reach FluidRelinearization::relinearizeWorst() {
  const auto worse = [](const Stale& a, const Stale& b) {
    return a.turn_rad > b.turn_rad || (a.turn_rad == b.turn_rad && a.variable < b.variable);
  };
  ranked_.clear();
  for (const VariableId v : stale_) ranked_.push_back({staleness_rad_[v.value], v});
  double urgent_flops = params_.urgent_flops, polish_flops = params_.polish_flops;
  auto reach = Reach::kWithin;
  for (auto next = ranked_.begin(); next != ranked_.end() && reach == Reach::kWithin;) {
    const auto end = next + std::min(kWorstAtOnce, ranked_.end() - next);
    std::partial_sort(next, end, ranked_.end(), worse);
    for (; next != end && reach != Reach::kBeyondBudget; ++next) {
      const VariableId v = next->variable;
      if (!isStale(v)) continue;  // twice in the list, or of the region of one before it
      double& flops_left = staleness_rad_[v.value] > params_.relinearize_rad ? urgent_flops : polish_flops;
      reach = std::max(reach, relinearizeRegion(v, staleness_rad_[v.value], flops_left));
    }
    const auto done = std::remove_if(next, ranked_.end(), [&](const Stale& other) { return !isStale(other.variable); });
    ranked_.erase(done, ranked_.end());
  }
  return reach;
}

/// Relinearizes a few variables per step, in turn, that turned little. A closure may leave thousands of these: each
/// harms next to nothing, but all together do. They share the way to the root, so they are expensive only one by one.
void FluidRelinearization::relinearizeAtRest() {
  rest_flops_left_ = std::min(rest_flops_left_ + params_.rest_flops, params_.polish_flops);
  const int slots = static_cast<int>(graph_.slots());
  for (int i = 0; i < std::min(kLookedAtAtRest, slots); ++i) {
    next_at_rest_ = next_at_rest_ + 1 < slots ? next_at_rest_ + 1 : 0;
    const VariableId v{next_at_rest_};
    if (!graph_.contains(v) || tree_.cliqueOf(v) < 0) continue;
    if (const double turn = states_.turnSinceLinearization(v); turn > params_.rest_share * params_.leisurely_rad)
      relinearizeRegion(v, turn, rest_flops_left_);
  }
}

/// Relinearizes a variable and the connected ones that turned with it: new Jacobians of only a part of a stiff region
/// bias the rest.
FluidRelinearization::Reach FluidRelinearization::relinearizeRegion(VariableId worst, double worst_turn_rad,
                                                                    double& flops_left) {
  const double turn_rad = kTurnedWithShare * worst_turn_rad;
  if (const Reach reach = relinearizeWithin(worst, flops_left); reach != Reach::kWithin) return reach;
  region_.assign(1, worst);
  in_region_.reset(graph_.slots());
  in_region_.insert(worst.value);
  for (std::size_t i = 0; i < region_.size() && i < kLargestRegion; ++i)
    for (const FactorId f : graph_.factorsOf(region_[i]))
      for (const VariableId v : graph_.variablesOf(f)) {
        if (in_region_.contains(v.value) || states_.turnSinceLinearization(v) <= turn_rad) continue;
        in_region_.insert(v.value);
        if (relinearizeWithin(v, flops_left) == Reach::kWithin) region_.push_back(v);
      }
  return Reach::kWithin;
}

FluidRelinearization::Reach FluidRelinearization::relinearizeWithin(VariableId v, double& flops_left) {
  const Cost cost = costOfRelinearizing(v, flops_left);
  if (!budget_.affords(cost.work)) return Reach::kBeyondBudget;
  if (cost.volume > flops_left) return Reach::kBeyondAllowance;
  budget_.plan(cost.work);
  flops_left -= cost.volume;
  relinearize(v);
  return Reach::kWithin;
}

/// Cost of the cliques that are eliminated anew only for the variable; of a part of them where that is too much.
FluidRelinearization::Cost FluidRelinearization::costOfRelinearizing(VariableId v, double most_volume) {
  counted_.reset(tree_.slots());
  const bool counts_flops = budget_.limitsFlops();  // they would take a twentieth of an update to count
  const bool limited = budget_.limited();
  CliqueCost work;
  double volume = 0;
  for (const FactorId f : graph_.factorsOf(v)) {
    if (new_factors_.contains(f.value)) continue;
    for (int c = tree_.ownerOf(graph_.variablesOf(f)); c >= 0 && !work_.isEliminated(c) && counted_.insert(c);
         c = tree_[c].parent) {
      work.scalars += tree_[c].frontal_size;
      volume += static_cast<double>(tree_[c].frontal_size) * tree_[c].size * tree_[c].size;
      if (counts_flops) work.flops += eliminationCost(tree_[c]).flops;
      if (limited ? !budget_.affords(work) : volume > most_volume) return {work, volume};
    }
  }
  return {work, volume};
}

/// True when all cliques that the variable's relinearization concerns are eliminated anew in any case.
bool FluidRelinearization::isFree(VariableId v) const {
  return std::ranges::all_of(graph_.factorsOf(v), [&](FactorId f) {
    const int owner = new_factors_.contains(f.value) ? -1 : tree_.ownerOf(graph_.variablesOf(f));
    return owner < 0 || work_.isEliminated(owner);
  });
}

/// Moves the variable's linearization point. Its factors get new Jacobians when those of all variables have moved.
void FluidRelinearization::relinearize(VariableId v) {
  states_.moveLinearizationPoint(v);
  staleness_rad_[v.value] = 0;
  ++corrections_.relinearized_variables;
  for (const FactorId f : graph_.factorsOf(v)) {
    if (!is_relinearized_.insert(f.value)) continue;
    relinearized_.push_back(f);
    budget_.count(kFlopsPerLinearized);
    if (!new_factors_.contains(f.value)) work_.markRefresh(tree_.ownerOf(graph_.variablesOf(f)));
  }
}

/// Corrects a model's residual r, which changes the right-hand side of its clique by J^T r.
void FluidRelinearization::correctResidual(FactorId id) {
  const auto mismatch = models_.mismatch(id);
  models_.correctResidual(id, mismatch);
  ++corrections_.corrected_factors;
  const int owner = tree_.ownerOf(graph_.variablesOf(id));
  const std::span<double> change = work_.markShift(owner);
  if (change.empty()) return;  // the clique is eliminated anew
  const bool gradient = !models_.isJacobian(id);
  const Eigen::Map<const Eigen::VectorXd> r(mismatch.r.data(), static_cast<Eigen::Index>(mismatch.r.size()));
  int column = 0;
  for (const VariableId v : graph_.variablesOf(id)) {
    const int row = firstRowOf(v, tree_[owner], graph_);
    for (int i = 0; i < graph_.sizeOf(v); ++i, ++column)
      change[row + i] += gradient ? r[column] : models_.term(id).col(column).dot(r);
  }
}

}  // namespace motorcade
