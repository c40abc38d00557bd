#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "apps/tasks/task_performer.hpp"

namespace motorcade {

/// Runs the steps of one task as child processes, within its time, until it is stopped.
class TaskSteps {
 public:
  /// Works in `folder`, which exists and gets the log.
  TaskSteps(const Workplace& workplace, std::filesystem::path folder);

  /// Runs the program with these words; false when it failed or was stopped.
  bool run(const std::string& step, const std::vector<std::string>& words);

  bool stopped() const { return workplace_.stop != nullptr && *workplace_.stop; }
  /// Failure of a step; empty where none failed or the task was stopped.
  const std::optional<TaskFailure>& failure() const { return failure_; }
  double cpu_s() const { return cpu_s_; }
  std::int64_t peakMemory_bytes() const { return peak_memory_bytes_; }

 private:
  using Clock = std::chrono::steady_clock;
  bool outOfTime() const;

  const Workplace& workplace_;
  std::filesystem::path folder_;
  Clock::time_point start_ = Clock::now();
  std::optional<TaskFailure> failure_;
  double cpu_s_ = 0;
  std::int64_t peak_memory_bytes_ = 0;
};

}  // namespace motorcade
