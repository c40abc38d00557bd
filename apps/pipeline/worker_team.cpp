#include "apps/pipeline/worker_team.hpp"

#include <exception>

namespace motorcade {

namespace flow = oneapi::tbb::flow;

void WorkerTeam::Hold::add() {
  graph_.reserve_wait();
  ++count_;
}

void WorkerTeam::Hold::drop() {
  int count = count_;
  while (count > 0 && !count_.compare_exchange_weak(count, count - 1)) {
  }
  if (count > 0) graph_.release_wait();
}

void WorkerTeam::Hold::dropAll() {
  for (int count = count_.exchange(0); count > 0; --count) graph_.release_wait();
}

WorkerTeam::WorkerTeam(oneapi::tbb::task_arena& arena, int workers, const ThreadPlacement& placement)
    : arena_(arena), placement_(placement), spread_(static_cast<std::size_t>(workers)) {
  arena_.execute([&] {  // where the graphs are made, they are awaited
    for (int i = 0; i < workers; ++i) seats_.push_back(std::make_unique<Seat>());
  });
  for (int i = 1; i < workers; ++i) helpers_.emplace_back([this](const std::stop_token& stopped) { help(stopped); });
}

WorkerTeam::~WorkerTeam() {
  for (const auto& seat : seats_) letGo(*seat);
}

/// A frame wants all workers until its tail. Each frame beyond the first also does, until one is finished.
void WorkerTeam::expect() {
  for (const auto& seat : seats_) {
    seat->alone.add();
    seat->as_one_of_all.add();
  }
  if (frames_.fetch_add(1) > 0)
    for (const auto& seat : seats_) seat->as_one_of_all.add();
}

void WorkerTeam::call() {
  events_.fetch_add(1, std::memory_order_release);
  events_.notify_all();
}

void WorkerTeam::reachTail() {
  last_ = thisSeat();
  for (const auto& seat : seats_) seat->as_one_of_all.drop();
}

void WorkerTeam::finish() {
  last_ = thisSeat();
  const bool others = frames_.fetch_sub(1) > 1;
  for (const auto& seat : seats_) {
    if (others) seat->as_one_of_all.drop();
    seat->alone.drop();
  }
}

/// Lets the leader go, which from then on watches how the graph ends: the frames that it waits for may never be
/// finished. A leader that does not lead yet sees that the team is closed.
void WorkerTeam::close() {
  closed_ = true;
  if (Seat* const seat = leader_) letGo(*seat);
  call();
}

void WorkerTeam::letGo(Seat& seat) {
  seat.as_one_of_all.dropAll();
  seat.alone.dropAll();
}

/// Works while all workers are wanted. Afterwards one thread that has just worked on a frame stays until the last frame
/// is finished.
void WorkerTeam::work() {
  occupy();
  Seat& seat = *seats_[thisSeat()];
  seat.as_one_of_all.await();
  if (last_ == thisSeat()) seat.alone.await();
}

void WorkerTeam::lead(flow::graph& graph) {
  leader_ = seats_[thisSeat()].get();
  for (;;) {
    const auto seen = events_.load(std::memory_order_acquire);
    if (closed_) break;
    work();
    events_.wait(seen, std::memory_order_acquire);
  }
  graph.wait_for_all();
}

/// No exception may leave the thread. An error here belongs to no frame, and the other threads work on without this
/// one.
void WorkerTeam::help(const std::stop_token& stopped) try {
  const PlacedThread placed(placement_);
  const std::stop_callback wake(stopped, [this] { call(); });
  arena_.execute([&] {
    for (;;) {
      const auto seen = events_.load(std::memory_order_acquire);
      if (stopped.stop_requested()) return;
      work();
      events_.wait(seen, std::memory_order_acquire);
    }
  });
} catch (const std::exception&) {
}

}  // namespace motorcade
