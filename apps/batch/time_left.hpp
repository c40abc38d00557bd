#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "apps/tasks/plan.hpp"

namespace motorcade {

/// The work of a task in frames, with its overhead. A task whose frames are not known counts its overhead alone.
double weightOf(const Task& task);

/// Frames that a run has written so far.
double framesWritten(const std::filesystem::path& run);

/// Predicts the time that the rest of the work will take from the time of the work so far.
class TimeLeft {
 public:
  explicit TimeLeft(double whole) : whole_(whole) {}
  /// Text such as `2 h 5 min left`. Before any work is done it says that the time is not known.
  std::string text(double done) const;

 private:
  using Clock = std::chrono::steady_clock;
  double whole_;
  Clock::time_point start_ = Clock::now();
};

/// Text such as `2 h 5 min`, `3 min`, `40 s`.
std::string durationText(double seconds);

}  // namespace motorcade
