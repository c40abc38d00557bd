#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

#include "apps/tasks/plan.hpp"

namespace motorcade {

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

}  // namespace motorcade
