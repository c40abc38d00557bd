#pragma once

#include <atomic>
#include <chrono>

#include "core/messages.hpp"
#include "core/timestamp.hpp"

namespace motorcade {

/// Times at which the pairs of a replayed drive are due. It starts once, with the first pair; from then on any thread
/// may ask.
class CameraClock {
 public:
  /// `pace` is the number of captured seconds per second of replay, `period_s` the capture's mean period.
  CameraClock(double pace, double period_s) : pace_(pace), period_s_(period_s) {}

  void start(Timestamp first, SteadyTime now) {
    first_ = first;
    origin_.store(now.time_since_epoch().count(), std::memory_order_release);
  }
  /// Delays all further pairs, as the replay was held.
  void postpone(SteadyTime::duration held) { origin_.fetch_add(held.count(), std::memory_order_acq_rel); }
  bool started() const { return origin_.load(std::memory_order_acquire) != 0; }

  /// Call it after `start`.
  SteadyTime due(Timestamp stamp) const {
    const SteadyTime origin{SteadyTime::duration(origin_.load(std::memory_order_acquire))};
    return origin + replayed(secondsBetween(first_, stamp));
  }

  /// True when a camera that does not wait has already captured the next pair.
  bool overtaken(Timestamp stamp, SteadyTime now) const { return started() && now >= due(stamp) + replayed(period_s_); }

 private:
  SteadyTime::duration replayed(double captured_s) const {
    return std::chrono::duration_cast<SteadyTime::duration>(std::chrono::duration<double>(captured_s / pace_));
  }

  double pace_, period_s_;
  Timestamp first_;
  std::atomic<SteadyTime::rep> origin_{0};  // published after `first_`
};

}  // namespace motorcade
