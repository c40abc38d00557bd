#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

#include "apps/tasks/batch_folder.hpp"
#include "apps/tasks/plan.hpp"
#include "apps/tasks/task_record.hpp"

namespace motorcade {

/// The processors that this process may use, in ascending order.
std::vector<int> usableProcessors();

/// The processors of each of `jobs` tasks that run side by side, so that their times are comparable. With fewer
/// processors than `jobs` times `threads`, tasks may use any: the lists are empty.
std::vector<std::vector<int>> processorSlots(const std::vector<int>& usable, int jobs, int threads);

/// The remaining work, shared by several workers: the tasks in their order, and each scene's rendering, once, before
/// its tasks. A task whose sequence is being rendered is passed over until that is done. Thread safe.
class TaskQueue {
 public:
  struct Item {
    const Task* task = nullptr;
    bool only_render = false;
  };

  /// The tasks live longer than the queue.
  explicit TaskQueue(const std::vector<const Task*>& tasks);

  /// Waits until something can be done; empty when nothing is left or the queue was stopped.
  std::optional<Item> next();
  /// A worker that took an item calls this when it is done, well or not.
  void done(const Item& item);
  /// Gives out no further items.
  void stop();

 private:
  std::optional<Item> takeReady();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> items_;
  std::set<std::filesystem::path> unrendered_;
  bool stopped_ = false;
};

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
