#include "backend/solver/update_budget.hpp"

#include <algorithm>
#include <limits>

namespace motorcade {
namespace {

constexpr auto kUnlimited = std::numeric_limits<std::int64_t>::max();
/// Of a budget: the most that is saved, or an update would in the end cost a multiple of it.
constexpr std::int64_t kSavedShare = 2;
constexpr double kPaceShare = 0.1;  // of the newest update in the mean pace: it follows within some ten updates

}  // namespace

void UpdateBudget::beginUpdate(std::int64_t backlog) {
  const std::int64_t left_over = limited_ ? left_ : 0;
  left_ = params_.scalars > 0 ? params_.scalars : kUnlimited;
  if (params_.ms > 0 && work_per_ms_ > 0) left_ = std::min(left_, static_cast<std::int64_t>(params_.ms * work_per_ms_));
  limited_ = left_ != kUnlimited;
  kept_ = 0;
  if (limited_) {
    kept_ = std::min(backlog, left_);
    left_ += std::min(left_over, saves_ ? left_ / kSavedShare : 0);
  }
  saves_ = false;
}

void UpdateBudget::lift() {
  left_ = kUnlimited;
  kept_ = 0;
  limited_ = false;
}

void UpdateBudget::spend(std::int64_t work) {
  if (limited_) left_ -= work;
}

void UpdateBudget::notePace(std::int64_t work, double update_ms) {
  if (work == 0 || update_ms <= 0) return;
  const double now = static_cast<double>(work) / update_ms;
  work_per_ms_ = work_per_ms_ > 0 ? work_per_ms_ + kPaceShare * (now - work_per_ms_) : now;
}

}  // namespace motorcade
