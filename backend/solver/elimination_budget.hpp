#pragma once

#include <chrono>
#include <cstdint>

namespace motorcade {

/// How many scalars an update may eliminate beyond what its new factors ask for, and how many it may substitute. What
/// an update leaves is saved for the next one while a variable waits whose relinearization costs more.
class EliminationBudget {
 public:
  struct Params {
    std::int64_t scalars = 0;  // per update; 0: no limit
    /// Time of an update, so that results depend on the machine; 0: no limit. Half of it is for eliminations, at the
    /// pace of those before; then substitution and comparisons of models go on until it is over.
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

  /// What is left to do can wait for the next update. False without a limit of time.
  bool timeIsOver() const { return spentMoreThan(1); }
  bool timeForEliminationsIsOver() const;
  /// Of eliminations; it matters with a limit of time only.
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
