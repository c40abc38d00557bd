#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>
#include <vector>

#include <sched.h>
#include <sys/types.h>

namespace motorcade {

/// Keeps threads that work together off each other's processors. Linux may take a sleeping virtual processor for one
/// that the hypervisor has taken away. It then lets a woken thread wait for milliseconds behind the thread that woke
/// it, while the other processor stands idle. So each thread is kept off the processors on which the others worked
/// last, and may run on all others. Without effect where there are fewer processors than threads.
class ThreadSpread {
 public:
  explicit ThreadSpread(std::size_t threads) : seats_(threads) {}

  /// Notes where the thread of a seat runs. That thread calls it when it begins work, before others rely on its place.
  /// Costs a few nanoseconds where the thread has not moved.
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
