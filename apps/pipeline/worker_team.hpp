#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <thread>
#include <vector>

#include <oneapi/tbb/flow_graph.h>
#include <oneapi/tbb/task_arena.h>

#include "core/thread_placement.hpp"
#include "core/thread_spread.hpp"

namespace motorcade {

/// The threads that work on a flow graph: its own, in the slots of its arena, and none of oneTBB's, which come from
/// other arenas and go to them. While there is nothing to do they sleep, and do not look for work first as oneTBB's
/// would; a call wakes all of them at once. One of them leads: it waits for the graph, the others for it.
class WorkerTeam {
 public:
  /// Starts all but the leader. `arena` has `workers` slots, all of them reserved for threads that enter it.
  WorkerTeam(oneapi::tbb::task_arena& arena, int workers, const ThreadPlacement& placement);
  /// After the leader has come back and the last call.
  ~WorkerTeam();
  WorkerTeam(const WorkerTeam&) = delete;
  WorkerTeam& operator=(const WorkerTeam&) = delete;

  /// The graph got something to do. From one thread.
  void call();
  /// No further call comes; from any thread.
  void close();
  /// Leader, in the arena: works on the graph until it is closed and all is done. Throws what a node threw.
  void lead(oneapi::tbb::flow::graph& graph);
  /// A thread of the team begins with something.
  void settle() { spread_.settle(seat()); }

 private:
  static std::size_t seat() { return static_cast<std::size_t>(oneapi::tbb::this_task_arena::current_thread_index()); }
  void help(oneapi::tbb::flow::graph& busy, const std::stop_token& stopped);
  void letGo(std::uint32_t calls);
  void signal();

  oneapi::tbb::task_arena& arena_;
  ThreadPlacement placement_;
  ThreadSpread spread_;
  std::atomic<std::uint32_t> events_{0}, calls_{0};
  std::atomic<bool> closed_{false};
  std::uint32_t done_ = 0;  // calls of which the leader knows that all is done
  /// What each helper waits for: a graph without nodes, which is held from a call until all is done.
  std::vector<std::unique_ptr<oneapi::tbb::flow::graph>> busy_;
  std::vector<std::jthread> helpers_;
};

}  // namespace motorcade
