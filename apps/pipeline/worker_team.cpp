#include "apps/pipeline/worker_team.hpp"

#include <exception>

namespace motorcade {

namespace flow = oneapi::tbb::flow;

WorkerTeam::WorkerTeam(oneapi::tbb::task_arena& arena, int workers, const ThreadPlacement& placement)
    : arena_(arena), placement_(placement), spread_(static_cast<std::size_t>(workers)) {
  arena_.execute([&] {
    for (int i = 1; i < workers; ++i) busy_.push_back(std::make_unique<flow::graph>());
  });
  for (const auto& busy : busy_)
    helpers_.emplace_back([this, &busy = *busy](const std::stop_token& stopped) { help(busy, stopped); });
}

WorkerTeam::~WorkerTeam() { letGo(calls_); }

void WorkerTeam::call() {
  for (const auto& busy : busy_) busy->reserve_wait();
  calls_.fetch_add(1);
  signal();
}

void WorkerTeam::close() {
  closed_ = true;
  signal();
}

void WorkerTeam::signal() {
  events_.fetch_add(1, std::memory_order_release);
  events_.notify_all();
}

/// What was called before `closed_` was seen is done by then.
void WorkerTeam::lead(flow::graph& graph) {
  for (;;) {
    const auto seen = events_.load(std::memory_order_acquire);
    const bool closed = closed_;
    const std::uint32_t calls = calls_;
    settle();
    graph.wait_for_all();
    letGo(calls);
    if (closed) return;
    events_.wait(seen, std::memory_order_acquire);
  }
}

void WorkerTeam::letGo(std::uint32_t calls) {
  for (; done_ != calls; ++done_)
    for (const auto& busy : busy_) busy->release_wait();
}

/// Nothing may leave the thread: what goes wrong here is no frame's, and the leader works alone.
void WorkerTeam::help(flow::graph& busy, const std::stop_token& stopped) try {
  const PlacedThread placed(placement_);
  const std::stop_callback wake(stopped, [this] { signal(); });
  arena_.execute([&] {
    for (;;) {
      const auto seen = events_.load(std::memory_order_acquire);
      if (stopped.stop_requested()) return;
      settle();
      busy.wait_for_all();
      events_.wait(seen, std::memory_order_acquire);
    }
  });
} catch (const std::exception&) {
}

}  // namespace motorcade
