#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>
#include <vector>

#include <sched.h>
#include <sys/types.h>

namespace motorcade {

/// Keeps threads that work together off each other's processors. Where a virtual processor has gone to sleep, Linux may
/// take it for one that the hypervisor has taken away, and lets a thread that it wakes wait behind the one that woke
/// it, for milliseconds, while the other processor stands idle. So each thread is kept off the processors on which the
/// others worked last; it may run on all others. Without effect where there are fewer processors than threads.
class ThreadSpread {
 public:
  explicit ThreadSpread(std::size_t threads) : seats_(threads) {}

  /// Called by the thread of each seat when it begins with something, before others rely on where it is. Costs a few
  /// nanoseconds where it has not moved.
  void occupy(std::size_t seat);

 private:
  struct Seat {
    std::atomic<int> cpu{-1};
    pid_t thread = 0;  // 0: has not been occupied yet
    cpu_set_t allowed;
  };
  void keepOff(const Seat& seat) const;

  std::vector<Seat> seats_;
  std::mutex mutex_;  // of all but `cpu`
};

}  // namespace motorcade
