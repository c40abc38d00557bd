#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "apps/tasks/plan.hpp"

namespace motorcade {

/// How much work a task is, in frames; also of one whose frames are not known.
double weightOf(const Task& task);

/// Frames that a run has written so far.
double framesWritten(const std::filesystem::path& run);

/// Tells how long the rest of the work will take, from how long the work so far took.
class TimeLeft {
 public:
  explicit TimeLeft(double whole) : whole_(whole) {}
  /// As `2 h 5 min left`; says that it is not known before any work is done.
  std::string text(double done) const;

 private:
  using Clock = std::chrono::steady_clock;
  double whole_;
  Clock::time_point start_ = Clock::now();
};

/// As `2 h 5 min`, `3 min`, `40 s`.
std::string durationText(double seconds);

}  // namespace motorcade
