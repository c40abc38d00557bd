#include "backend/solver/elimination_budget.hpp"

#include <algorithm>
#include <limits>

namespace motorcade {
namespace {

/// Substituting a scalar and comparing the models that it moves costs an eighth of eliminating one.
constexpr std::int64_t kSubstitutionsPerElimination = 8;
/// Budgets, or an update would in the end cost a multiple of it.
constexpr std::int64_t kMostSaved = 1;
constexpr double kPaceShare = 0.1;  // of the newest update in the mean pace: it follows within some ten updates

}  // namespace

void EliminationBudget::beginUpdate() {
  constexpr auto kUnlimited = std::numeric_limits<std::int64_t>::max();
  left_ = params_.scalars > 0 ? params_.scalars : kUnlimited;
  if (params_.ms > 0 && scalars_per_ms_ > 0)
    left_ = std::min(left_, static_cast<std::int64_t>(params_.ms * scalars_per_ms_));
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

void EliminationBudget::notePace(std::int64_t eliminated_scalars, double update_ms) {
  if (eliminated_scalars == 0 || update_ms <= 0) return;
  const double now = static_cast<double>(eliminated_scalars) / update_ms;
  scalars_per_ms_ = scalars_per_ms_ > 0 ? scalars_per_ms_ + kPaceShare * (now - scalars_per_ms_) : now;
}

}  // namespace motorcade
