#pragma once

#include <string>
#include <vector>

namespace motorcade {

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

}  // namespace motorcade
