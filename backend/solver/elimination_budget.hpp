#pragma once

#include <cstdint>

namespace motorcade {

/// How many scalars an update may eliminate beyond what its new factors ask for, and how many it may substitute. What
/// an update leaves is saved for the next one while a variable waits whose relinearization costs more.
class EliminationBudget {
 public:
  struct Params {
    std::int64_t scalars = 0;  // per update; 0: no limit
    /// The same as time, at the pace of the updates before, so that results depend on the machine; 0: no limit.
    double ms = 0;
  };

  explicit EliminationBudget(const Params& params) : params_(params) {}

  void beginUpdate();
  /// Nothing limits the rest of the update.
  void lift();
  std::int64_t left() const { return left_; }
  void spend(std::int64_t scalars) { left_ -= scalars; }
  /// Factors that ask for no more than so many scalars are never put off.
  static constexpr std::int64_t kLeast = 600;
  bool limited() const { return limited_; }
  std::int64_t substitutionsLeft() const { return substitutions_left_; }
  void spendSubstitutions(std::int64_t scalars) { substitutions_left_ -= scalars; }
  /// Sets aside for the next update what is left for substitution, or nothing.
  void saveSubstitutions(bool model_waits) { saved_substitutions_ = model_waits ? substitutions_left_ : 0; }
  /// Sets aside for the next update what is left, or nothing.
  void save(bool variable_waits) { saved_ = variable_waits ? left_ : 0; }

  /// Only with a limit of time the pace matters.
  bool countsTime() const { return params_.ms > 0; }
  void notePace(std::int64_t eliminated_scalars, double update_ms);

 private:
  Params params_;
  std::int64_t left_ = 0, saved_ = 0, substitutions_left_ = 0, saved_substitutions_ = 0;
  bool limited_ = false;
  double scalars_per_ms_ = 0;  // mean over the updates so far; 0 before the first
};

}  // namespace motorcade
