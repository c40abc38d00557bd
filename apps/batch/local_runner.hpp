#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <vector>

#include "apps/batch/task_queue.hpp"
#include "apps/tasks/batch_folder.hpp"
#include "apps/tasks/plan.hpp"
#include "apps/tasks/task_record.hpp"

namespace motorcade {

/// Outcome of the tasks that were to be performed.
struct LocalOutcome {
  std::size_t done = 0;
  std::vector<TaskRecord> failed{};
};

/// Performs tasks on this machine, each in child processes, one per slot at a time.
class LocalRunner {
 public:
  struct Options {
    std::vector<std::vector<int>> slots{};  // one per task at a time: its processors, none for any
    std::chrono::seconds limit{0};          // of a task; 0 for none
  };
  LocalRunner(const Plan& plan, const BatchFolder& folder, Options options);

  /// Returns when all are performed or `stop` was called.
  LocalOutcome perform(const std::vector<const Task*>& tasks);
  /// Ends the running processes in order and starts no others; callable from any thread.
  void stop();

 private:
  void work(TaskQueue& queue, std::size_t slot);
  void performItem(const TaskQueue::Item& item, std::size_t slot);
  void take(const TaskRecord& record);
  void showProgress(const std::vector<const Task*>& tasks);
  double runningFrames() const;

  const Plan& plan_;
  BatchFolder folder_;
  Options options_;
  std::atomic<bool> stop_ = false;
  mutable std::mutex mutex_;  // of all below
  LocalOutcome outcome_;
  std::vector<const Task*> running_;  // by slot; null where none is
  double frames_done_ = 0;
  std::size_t workers_left_ = 0;
};

}  // namespace motorcade
