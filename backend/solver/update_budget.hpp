#pragma once

#include <cstdint>

namespace motorcade {

/// How much work an update may do beyond what its new factors ask for: lifting, elimination for relinearization,
/// corrected residuals, and substitution below what was eliminated. What an update does not spend is saved while
/// something waits that costs more, and what it spends too much, as costs are only estimated, the next ones lack.
///
/// The unit of work is what elimination of a scalar costs in a small clique, about half a microsecond.
class UpdateBudget {
 public:
  struct Params {
    std::int64_t scalars = 0;  // per update; 0: no limit
    /// The same as time, at the pace of the updates before, so that results depend on the machine; 0: no limit.
    double ms = 0;
  };
  /// What costs a unit, too: so many scalars substituted, or whose right-hand side changes, so many models compared
  /// right after their variables moved, so many cliques passed in vain on the way to the root.
  static constexpr std::int64_t kSubstitutedPerUnit = 2, kCorrectedPerUnit = 2, kComparedPerUnit = 1,
                                kPassedPerUnit = 32;
  static constexpr std::int64_t kComparedLater = 2;  // units: the model, which has left the caches
  /// Factors that ask for no more work than this are never put off.
  static constexpr std::int64_t kLeast = 600;

  explicit UpdateBudget(const Params& params) : params_(params) {}

  /// So much of the budget is kept for substitution that earlier updates put off.
  void beginUpdate(std::int64_t backlog);
  /// Nothing limits the rest of the update.
  void lift();
  bool limited() const { return limited_; }
  /// For elimination; what is kept for substitution is not among it. Negative when too much was spent.
  std::int64_t left() const { return left_ - kept_; }
  std::int64_t leftForSubstitution() const { return left_; }
  void spend(std::int64_t work);
  /// Something waits that would have cost more than was left.
  void saveForNext() { saves_ = true; }

  /// Only with a limit of time the pace matters.
  bool countsTime() const { return params_.ms > 0; }
  void notePace(std::int64_t work, double update_ms);

 private:
  Params params_;
  std::int64_t left_ = 0, kept_ = 0;
  bool limited_ = false, saves_ = false;
  double work_per_ms_ = 0;  // mean over the updates so far; 0 before the first
};

}  // namespace motorcade
