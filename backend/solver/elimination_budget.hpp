#pragma once

#include <chrono>
#include <cstdint>
#include <limits>

#include "backend/elimination/clique_cost.hpp"

namespace motorcade {

/// Budget of an update: how much it may eliminate beyond what its new factors ask for, and how much it may substitute.
/// Unused budget is saved for the next update while a variable waits whose relinearization costs more.
class EliminationBudget {
 public:
  struct Params {
    std::int64_t scalars = 0;  // eliminated per update; 0: no limit
    /// Counted work of an update, see CliqueCost; 0: no limit. Half of it is for eliminations, then substitution goes
    /// on until four fifths are done.
    double flops = 0;
    /// Time of an update; results then depend on the machine; 0: no limit. It limits the work at the pace of the
    /// updates so far, and the clock is read on the way.
    double ms = 0;

    bool isLimited() const { return scalars > 0 || flops > 0 || ms > 0; }
  };

  explicit EliminationBudget(const Params& params) : params_(params) {}

  /// Begins an update. Less of its work is for eliminations if estimates lag, or if the one before ended in
  /// substitution.
  void beginUpdate(bool estimates_lag = false);
  /// Removes all limits for the rest of the update.
  void lift();
  bool limited() const { return limited_; }
  bool limitsFlops() const { return most_flops_ < kUnlimited; }

  /// Eliminations left.
  const CliqueCost& left() const { return left_; }
  bool affords(const CliqueCost& cost) const { return cost.scalars <= left_.scalars && cost.flops <= left_.flops; }
  /// Spends eliminations that are done at once, or that are planned.
  void spend(const CliqueCost& cost);
  void plan(const CliqueCost& cost) { spend(cost), planned_flops_ += cost.flops; }
  /// Counts the eliminations that were planned as what they took.
  void finishPlanned(double flops) { count(flops - planned_flops_), planned_flops_ = 0; }
  /// Saves the eliminations left for the next update if a variable waits, else nothing.
  void save(bool variable_waits);
  /// Cost up to which factors are never put off.
  static constexpr CliqueCost kLeast{.scalars = 600, .flops = 2e7};

  std::int64_t substitutionsLeft() const { return substitutions_left_; }
  /// True when so many scalars may still be substituted, and flops be counted.
  bool affordsSubstitution(std::int64_t scalars, double flops) const {
    return scalars <= substitutions_left_ && done_flops_ + flops <= most_flops_;
  }
  void spendSubstitutions(std::int64_t scalars) { substitutions_left_ -= scalars; }
  /// Saves the substitutions left for the next update if a model waits, else nothing.
  void saveSubstitutions(bool model_waits) { saved_substitutions_ = model_waits ? substitutions_left_ : 0; }

  /// Counts work of any kind that was done or is sure to be.
  void count(double flops) { done_flops_ += flops; }
  double doneFlops() const { return done_flops_; }
  /// True when the rest of the work can wait for the next update. Always false without a limit of work or time.
  bool isOver() const { return spentMoreThan(1); }
  bool isOverForEliminations() const;
  bool isOverForSubstitution() const;
  /// Ends an update and notes its pace.
  void endUpdate();
  void notePace(double flops, double ms);

 private:
  double spent_ms() const;
  bool spentMoreThan(double share) const;

  static constexpr double kUnlimited = std::numeric_limits<double>::infinity();

  Params params_;
  CliqueCost left_, saved_;
  std::int64_t substitutions_left_ = 0, saved_substitutions_ = 0;
  double most_flops_ = kUnlimited, elimination_share_ = 1, done_flops_ = 0,
         planned_flops_ = 0;  // of the update; the planned ones are among the done
  bool limited_ = false, ended_in_substitution_ = false;
  std::chrono::steady_clock::time_point began_;
  double paced_flops_ = 0, paced_ms_ = 0;  // of the updates so far, the newest ones with the most weight
};

}  // namespace motorcade
