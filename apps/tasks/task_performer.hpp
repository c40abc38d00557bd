#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/tasks/batch_folder.hpp"
#include "apps/tasks/plan.hpp"
#include "apps/tasks/task_record.hpp"

namespace motorcade {

/// Place and limits of the work on a task.
struct Workplace {
  BatchFolder folder;
  std::filesystem::path program{};          // the motorcade that does the work
  std::string program_stamp{};              // as it was when the tasks were planned
  std::string attempt{};                    // what sets this attempt's folder apart from those of others
  std::vector<int> processors{};            // that its processes are kept to; empty for any
  std::chrono::seconds limit{0};            // of one task; 0 for none
  const std::atomic<bool>* stop = nullptr;  // set from outside: end in order
};

/// Does the work of a task in a folder of its own, `attempts/TASK~ATTEMPT`: renders the sequence if need be, runs it
/// and, where there is truth, evaluates the run. When all is done, the folder moves to the results; a second attempt at
/// the same task, at the same time or later, does no harm. A failure is kept among the failures, with a record of the
/// reason. Empty when it was stopped: then nothing is left. Throws OutputError where not even that can be written.
std::optional<TaskRecord> performTask(const Task& task, const Workplace& workplace);

/// Makes sure that the task's sequence has been rendered. Its folder appears only when it is complete. Returns the
/// failure. A recorded drive needs nothing.
std::optional<TaskFailure> renderSequence(const Task& task, const Workplace& workplace);

/// The record of a finished task that need not be performed again, as the manifest's entry, configuration, program and
/// input are the same. Empty where there is none.
std::optional<TaskRecord> finishedRecord(const Task& task, const BatchFolder& folder);
/// The record of a failed task that need not be performed again.
std::optional<TaskRecord> failedRecord(const Task& task, const BatchFolder& folder);

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
