#include "backend/solver/elimination_budget.hpp"

#include <algorithm>
#include <limits>

namespace motorcade {
namespace {

constexpr double kPaceShare = 0.1;  // of the newest update in the mean pace: it follows within some ten updates

}  // namespace

void EliminationBudget::beginUpdate() {
  left_ = std::numeric_limits<std::int64_t>::max();
  if (params_.scalars > 0) left_ = params_.scalars + saved_;
  if (params_.ms > 0 && scalars_per_ms_ > 0)
    left_ = std::min(left_, static_cast<std::int64_t>(params_.ms * scalars_per_ms_) + saved_);
}

void EliminationBudget::notePace(std::int64_t eliminated_scalars, double update_ms) {
  if (eliminated_scalars == 0 || update_ms <= 0) return;
  const double now = static_cast<double>(eliminated_scalars) / update_ms;
  scalars_per_ms_ = scalars_per_ms_ > 0 ? scalars_per_ms_ + kPaceShare * (now - scalars_per_ms_) : now;
}

}  // namespace motorcade
