#pragma once

#include <chrono>
#include <cstdint>

namespace motorcade {

/// Budget of an update: how many scalars it may eliminate beyond those that its new factors ask for, and how many it
/// may substitute. Unused budget is saved for the next update while a variable waits whose relinearization costs more.
class EliminationBudget {
 public:
  struct Params {
    std::int64_t scalars = 0;  // per update; 0: no limit
    /// Time of an update; results then depend on the machine; 0: no limit. Half of it is for eliminations, at the pace
    /// of those before. Substitution and comparisons of models go on until it is over.
    double ms = 0;
  };

  explicit EliminationBudget(const Params& params) : params_(params) {}

  void beginUpdate();
  /// Removes all limits for the rest of the update.
  void lift();
  std::int64_t left() const { return left_; }
  void spend(std::int64_t scalars) { left_ -= scalars; }
  /// Scalars up to which factors are never put off.
  static constexpr std::int64_t kLeast = 600;
  bool limited() const { return limited_; }
  std::int64_t substitutionsLeft() const { return substitutions_left_; }
  void spendSubstitutions(std::int64_t scalars) { substitutions_left_ -= scalars; }
  /// Saves the substitutions left for the next update if a model waits, else nothing.
  void saveSubstitutions(bool model_waits) { saved_substitutions_ = model_waits ? substitutions_left_ : 0; }
  /// Saves the eliminations left for the next update if a variable waits, else nothing.
  void save(bool variable_waits) { saved_ = variable_waits ? left_ : 0; }

  /// True when the rest of the work can wait for the next update. Always false without a limit of time.
  bool timeIsOver() const { return spentMoreThan(1); }
  bool timeForEliminationsIsOver() const;
  /// Notes the pace of eliminations, which matters with a limit of time only.
  void notePace(std::int64_t scalars, double ms);

 private:
  bool spentMoreThan(double share) const;

  Params params_;
  std::int64_t left_ = 0, saved_ = 0, substitutions_left_ = 0, saved_substitutions_ = 0;
  bool limited_ = false;
  std::chrono::steady_clock::time_point began_;
  double scalars_per_ms_ = 0;  // of the eliminations so far; 0 before the first
};

}  // namespace motorcade
