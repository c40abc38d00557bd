#include "apps/batch/task_queue.hpp"

#include <algorithm>

namespace motorcade {

TaskQueue::TaskQueue(const std::vector<const Task*>& tasks) {
  for (const Task* const task : tasks)
    if (!task->render_arguments.empty() && task->problem.empty() && !std::filesystem::exists(task->sequence) &&
        unrendered_.insert(task->sequence).second)
      items_.push_back({task, true});
  for (const Task* const task : tasks) items_.push_back({task, false});
}

std::optional<TaskQueue::Item> TaskQueue::next() {
  std::unique_lock lock(mutex_);
  std::optional<Item> item;
  changed_.wait(lock, [&] { return stopped_ || items_.empty() || (item = takeReady()).has_value(); });
  return item;
}

void TaskQueue::done(const Item& item) {
  if (!item.only_render) return;
  const std::lock_guard lock(mutex_);
  unrendered_.erase(item.task->sequence);
  changed_.notify_all();
}

void TaskQueue::stop() {
  const std::lock_guard lock(mutex_);
  stopped_ = true;
  changed_.notify_all();
}

std::optional<TaskQueue::Item> TaskQueue::takeReady() {
  const auto ready = std::ranges::find_if(
      items_, [&](const Item& item) { return item.only_render || !unrendered_.contains(item.task->sequence); });
  if (ready == items_.end()) return std::nullopt;
  const Item item = *ready;
  items_.erase(ready);
  if (items_.empty()) changed_.notify_all();
  return item;
}

}  // namespace motorcade
