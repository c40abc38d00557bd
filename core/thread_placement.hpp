#pragma once

#include <atomic>
#include <cstddef>
#include <ctime>
#include <mutex>
#include <string>
#include <vector>

#include <sched.h>
#include <sys/types.h>

namespace motorcade {

/// Time that the calling thread has spent on a processor. Other programs on the machine do not count.
inline double threadCpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// Processors and priority of threads. The default leaves them as they are.
struct ThreadPlacement {
  std::vector<int> cpus{};    // processors that they may run on; empty: all
  int realtime_priority = 0;  // 1 to 99: SCHED_FIFO, ahead of all that is not; 0: as others
};

/// Places the calling thread while this lives, then restores it: workers go from one pipeline to another.
class PlacedThread {
 public:
  explicit PlacedThread(const ThreadPlacement& placement);
  ~PlacedThread();
  PlacedThread(const PlacedThread&) = delete;
  PlacedThread& operator=(const PlacedThread&) = delete;

  /// The system's reason for refusing a placement, in a sentence; empty when it accepts.
  const std::string& problem() const { return problem_; }

 private:
  void moveTo(const std::vector<int>& cpus);
  void hurry(int realtime_priority);

  std::vector<int> cpus_before_;
  bool hurried_ = false;
  int policy_before_ = 0, priority_before_ = 0;
  std::string problem_;
};

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
