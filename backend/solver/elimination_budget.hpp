#pragma once

#include <cstdint>

namespace motorcade {

/// How many scalars an update may eliminate beyond what its new factors ask for. What an update leaves is saved for the
/// next one while a variable waits whose relinearization costs more.
class EliminationBudget {
 public:
  struct Params {
    std::int64_t scalars = 0;  // per update; 0: no limit
    /// The same as time, at the pace of the updates before, so that results depend on the machine; 0: no limit.
    double ms = 0;
  };

  explicit EliminationBudget(const Params& params) : params_(params) {}

  void beginUpdate();
  std::int64_t left() const { return left_; }
  void spend(std::int64_t scalars) { left_ -= scalars; }
  /// Sets aside for the next update what is left, or nothing.
  void save(bool variable_waits) { saved_ = variable_waits ? left_ : 0; }

  /// Only with a limit of time the pace matters.
  bool countsTime() const { return params_.ms > 0; }
  void notePace(std::int64_t eliminated_scalars, double update_ms);

 private:
  Params params_;
  std::int64_t left_ = 0, saved_ = 0;
  double scalars_per_ms_ = 0;  // mean over the updates so far; 0 before the first
};

}  // namespace motorcade
