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

namespace motorcade {

/// The threads that work on the frames in a flow graph. They are its own, in the slots of its arena. oneTBB's threads
/// take no part, as they come from other arenas and go to them. When there is nothing to do they sleep at once, while
/// oneTBB's would look for work for milliseconds; a call wakes all of them. A frame that is alone keeps all of them
/// until it comes to stages that one thread does alone.
class WorkerTeam {
 public:
  /// Starts all but the leader. `arena` has `workers` slots, all of them reserved for threads that enter it.
  WorkerTeam(oneapi::tbb::task_arena& arena, int workers, const ThreadPlacement& placement);
  /// Runs after the last call, when the leader has returned.
  ~WorkerTeam();
  WorkerTeam(const WorkerTeam&) = delete;
  WorkerTeam& operator=(const WorkerTeam&) = delete;

  /// Called by one thread before and after a frame is put into the graph.
  void expect();
  void call();
  /// Called by a thread of the team: the rest of a frame is one thread's work (`reachTail`), or the frame is done
  /// (`finish`).
  void reachTail();
  void finish();
  /// Ends the calls; from any thread, also before the leader is at work.
  void close();
  /// Leader, in the arena: works on the graph until it is closed and all is done. Throws what a node threw.
  void lead(oneapi::tbb::flow::graph& graph);
  /// Called when a thread of the team begins with work.
  void occupy() { spread_.occupy(thisSeat()); }

 private:
  /// The condition that a worker waits for: a graph without nodes, which is held as long as the worker shall work.
  class Hold {
   public:
    void add();
    void drop();  // without effect once all were dropped
    void dropAll();
    void await() { graph_.wait_for_all(); }

   private:
    oneapi::tbb::flow::graph graph_;
    std::atomic<int> count_{0};
  };
  struct Seat {
    Hold as_one_of_all, alone;  // while all workers are wanted, and one
  };
  static std::size_t thisSeat() {
    return static_cast<std::size_t>(oneapi::tbb::this_task_arena::current_thread_index());
  }
  void help(const std::stop_token& stopped);
  void work();
  static void letGo(Seat& seat);

  oneapi::tbb::task_arena& arena_;
  ThreadPlacement placement_;
  ThreadSpread spread_;
  std::atomic<std::uint32_t> events_{0};
  std::atomic<bool> closed_{false};
  std::atomic<int> frames_{0};  // expected and not finished
  std::vector<std::unique_ptr<Seat>> seats_;
  std::atomic<std::size_t> last_{0};    // who stays where one is enough
  std::atomic<Seat*> leader_{nullptr};  // null until it leads
  std::vector<std::jthread> helpers_;
};

}  // namespace motorcade
