#include "apps/batch/local_runner.hpp"

#include <algorithm>
#include <cstddef>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <sched.h>

#include "apps/batch/batch_processes.hpp"
#include "apps/batch/time_left.hpp"
#include "apps/console/log.hpp"
#include "apps/console/progress.hpp"
#include "apps/tasks/task_performer.hpp"
#include "io/files/errors.hpp"

namespace motorcade {

std::vector<int> usableProcessors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  std::vector<int> usable;
  if (::sched_getaffinity(0, sizeof(set), &set) != 0) return usable;
  for (int processor = 0; processor < CPU_SETSIZE; ++processor)
    if (CPU_ISSET(static_cast<std::size_t>(processor), &set)) usable.push_back(processor);
  return usable;
}

std::vector<std::vector<int>> processorSlots(const std::vector<int>& usable, int jobs, int threads) {
  std::vector<std::vector<int>> slots(static_cast<std::size_t>(jobs));
  if (usable.size() < static_cast<std::size_t>(jobs) * static_cast<std::size_t>(threads)) return slots;
  auto next = usable.begin();
  for (auto& slot : slots) {
    slot.assign(next, next + threads);
    next += threads;
  }
  return slots;
}

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

namespace {

using namespace std::chrono_literals;

double framesOf(const std::vector<const Task*>& tasks) {
  double frames = 0;
  for (const Task* const task : tasks) frames += weightOf(*task);
  return frames;
}

}  // namespace

LocalRunner::LocalRunner(const Plan& plan, const BatchFolder& folder, Options options)
    : plan_(plan), folder_(folder), options_(std::move(options)) {}

void LocalRunner::stop() { stop_ = true; }

LocalOutcome LocalRunner::perform(const std::vector<const Task*>& tasks) {
  TaskQueue queue(tasks);
  running_.assign(options_.slots.size(), nullptr);
  workers_left_ = options_.slots.size();
  std::vector<std::jthread> workers;
  for (std::size_t slot = 0; slot < options_.slots.size(); ++slot)
    workers.emplace_back([this, &queue, slot] { work(queue, slot); });
  showProgress(tasks);
  workers.clear();  // waits for them
  return std::move(outcome_);
}

void LocalRunner::work(TaskQueue& queue, std::size_t slot) {
  while (!stop_) {
    const auto item = queue.next();
    if (!item) break;
    performItem(*item, slot);
    queue.done(*item);
  }
  queue.stop();  // nothing is left, or nobody may go on
  const std::lock_guard lock(mutex_);
  --workers_left_;
}

void LocalRunner::performItem(const TaskQueue::Item& item, std::size_t slot) {
  const Workplace workplace{.folder = folder_,
                            .program = plan_.program,
                            .program_stamp = plan_.program_stamp,
                            .attempt = localAttemptName(slot),
                            .processors = options_.slots[slot],
                            .limit = options_.limit,
                            .stop = &stop_};
  try {
    if (item.only_render) {
      renderSequence(*item.task,
                     workplace);  // what fails here fails again in the tasks of the scene, and is told there
      return;
    }
    {
      const std::lock_guard lock(mutex_);
      running_[slot] = item.task;
    }
    if (const auto record = performTask(*item.task, workplace)) take(*record);
  } catch (const UserError& error) {
    TaskRecord record{.task = item.task->name};
    record.failure = TaskFailure{.step = "record", .message = error.what()};
    take(record);
  }
  const std::lock_guard lock(mutex_);
  running_[slot] = nullptr;
  if (!item.only_render) frames_done_ += weightOf(*item.task);
}

void LocalRunner::take(const TaskRecord& record) {
  if (record.failure) {
    const auto& lines = record.failure->last_lines;
    logError(fmt::format("{}: {}{}", record.task, record.failure->message, lines.empty() ? "" : ": " + lines.back()));
  }
  const std::lock_guard lock(mutex_);
  if (record.failure)
    outcome_.failed.push_back(record);
  else
    ++outcome_.done;
}

double LocalRunner::runningFrames() const {
  double frames = 0;
  for (std::size_t slot = 0; slot < running_.size(); ++slot)
    if (running_[slot] != nullptr) {
      const auto attempt = folder_.attempts() / (running_[slot]->name + "~" + localAttemptName(slot));
      frames += std::min(framesWritten(runIn(attempt)), weightOf(*running_[slot]));
    }
  return frames;
}

void LocalRunner::showProgress(const std::vector<const Task*>& tasks) {
  constexpr auto kPeriod = 500ms;
  Progress progress("task", tasks.size());
  TimeLeft time_left(framesOf(tasks));
  while (true) {
    std::size_t done = 0, failed = 0;
    double frames = 0;
    {
      const std::lock_guard lock(mutex_);
      failed = outcome_.failed.size();
      done = outcome_.done + failed;
      frames = frames_done_ + runningFrames();
      if (workers_left_ == 0) break;
    }
    const std::string failures = failed > 0 ? fmt::format("{} failed, ", failed) : "";
    progress.show(done, failures + time_left.text(frames));
    std::this_thread::sleep_for(kPeriod);
  }
}

}  // namespace motorcade
