#include "backend/solver/elimination_budget.hpp"

#include <algorithm>

namespace motorcade {
namespace {

/// Substitutions at the cost of one elimination: substituting a scalar includes comparing the models that it moves.
constexpr std::int64_t kSubstitutionsPerElimination = 8;
/// Most that accumulates, in budgets of one update; with more, an update could cost a multiple of its budget.
constexpr std::int64_t kMostSaved = 1;
constexpr double kEliminationShare = 0.5, kShareWhileLagging = 0.1, kSubstitutionShare = 0.8,
                 kMostSavedShare = 0.2;  // of the work
constexpr double kPaceMemory_ms = 20;    // in which a new pace is found

}  // namespace

void EliminationBudget::beginUpdate(bool estimates_lag) {
  constexpr auto kAll = std::numeric_limits<std::int64_t>::max();
  most_flops_ = params_.flops > 0 ? params_.flops : kUnlimited;
  if (params_.ms > 0) began_ = std::chrono::steady_clock::now();
  if (params_.ms > 0 && paced_ms_ > 0) most_flops_ = std::min(most_flops_, params_.ms * paced_flops_ / paced_ms_);
  done_flops_ = planned_flops_ = 0;
  elimination_share_ = estimates_lag || ended_in_substitution_ ? kShareWhileLagging : kEliminationShare;
  left_ = {params_.scalars > 0 ? params_.scalars : kAll, elimination_share_ * most_flops_ + saved_.flops};
  limited_ = params_.scalars > 0 || most_flops_ < kUnlimited;
  substitutions_left_ = kAll;
  if (params_.scalars == 0) return;
  const std::int64_t least = std::max(params_.scalars, kLeast.scalars);
  substitutions_left_ = kSubstitutionsPerElimination * least + saved_substitutions_;
  left_.scalars += std::min(saved_.scalars, kMostSaved * least);
}

void EliminationBudget::lift() {
  left_ = {std::numeric_limits<std::int64_t>::max(), kUnlimited};
  substitutions_left_ = std::numeric_limits<std::int64_t>::max();
  most_flops_ = kUnlimited;
  limited_ = false;
}

void EliminationBudget::spend(const CliqueCost& cost) {
  left_.scalars -= cost.scalars;
  left_.flops -= cost.flops;
  count(cost.flops);
}

void EliminationBudget::save(bool variable_waits) {
  saved_ = variable_waits && limited_ ? left_ : CliqueCost{};
  saved_.flops = most_flops_ < kUnlimited ? std::clamp(saved_.flops, 0.0, kMostSavedShare * most_flops_) : 0;
}

double EliminationBudget::spent_ms() const {
  const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - began_;
  return spent.count();
}

bool EliminationBudget::spentMoreThan(double share) const {
  if (!limited_) return false;
  return done_flops_ > share * most_flops_ || (params_.ms > 0 && spent_ms() > share * params_.ms);
}

bool EliminationBudget::isOverForEliminations() const { return spentMoreThan(elimination_share_); }

bool EliminationBudget::isOverForSubstitution() const { return spentMoreThan(kSubstitutionShare); }

void EliminationBudget::endUpdate() {
  ended_in_substitution_ = isOverForSubstitution();
  if (params_.ms > 0) notePace(done_flops_, spent_ms());
}

void EliminationBudget::notePace(double flops, double ms) {
  paced_flops_ += flops;
  paced_ms_ += ms;
  if (paced_ms_ <= kPaceMemory_ms) return;
  paced_flops_ /= 2;
  paced_ms_ /= 2;
}

}  // namespace motorcade
