#include "backend/solver/elimination_budget.hpp"

#include <algorithm>
#include <limits>

namespace motorcade {
namespace {

/// Substitutions at the cost of one elimination: substituting a scalar includes comparing the models that it moves.
constexpr std::int64_t kSubstitutionsPerElimination = 8;
/// Most that accumulates, in budgets of one update; with more, an update could cost a multiple of its budget.
constexpr std::int64_t kMostSaved = 1;
constexpr double kPaceShare = 0.1;  // of a faster elimination in the mean pace; a slower one is the pace from then on
constexpr double kEliminationShare = 0.5;  // of the time

}  // namespace

void EliminationBudget::beginUpdate() {
  constexpr auto kUnlimited = std::numeric_limits<std::int64_t>::max();
  left_ = params_.scalars > 0 ? params_.scalars : kUnlimited;
  if (params_.ms > 0) began_ = std::chrono::steady_clock::now();
  if (params_.ms > 0 && scalars_per_ms_ > 0)
    left_ = std::min(left_, static_cast<std::int64_t>(kEliminationShare * params_.ms * scalars_per_ms_));
  limited_ = left_ != kUnlimited;
  substitutions_left_ = kUnlimited;
  if (!limited_) return;
  substitutions_left_ = kSubstitutionsPerElimination * std::max(left_, kLeast) + saved_substitutions_;
  left_ += std::min(saved_, kMostSaved * std::max(left_, kLeast));
}

void EliminationBudget::lift() {
  left_ = substitutions_left_ = std::numeric_limits<std::int64_t>::max();
  limited_ = false;
}

bool EliminationBudget::spentMoreThan(double share) const {
  if (params_.ms <= 0 || !limited_) return false;
  const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - began_;
  return spent.count() > share * params_.ms;
}

bool EliminationBudget::timeForEliminationsIsOver() const { return spentMoreThan(kEliminationShare); }

void EliminationBudget::notePace(std::int64_t scalars, double ms) {
  if (params_.ms <= 0 || scalars == 0 || ms <= 0) return;
  const double now = static_cast<double>(scalars) / ms;
  const bool slower = now < scalars_per_ms_ && scalars > kLeast;
  scalars_per_ms_ = scalars_per_ms_ > 0 && !slower ? scalars_per_ms_ + kPaceShare * (now - scalars_per_ms_) : now;
}

}  // namespace motorcade
