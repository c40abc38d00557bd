#pragma once

#include <atomic>
#include <cstdint>

namespace motorcade {

/// Counts the frames that wait on one edge of the flow graph. Safe to use from several threads.
class EdgeMeter {
 public:
  void enter() {
    const auto now = waiting_.fetch_add(1, std::memory_order_relaxed) + 1;
    auto seen = high_water_.load(std::memory_order_relaxed);
    while (seen < now && !high_water_.compare_exchange_weak(seen, now, std::memory_order_relaxed)) {
    }
  }
  void leave() { waiting_.fetch_sub(1, std::memory_order_relaxed); }
  std::int64_t waiting() const { return waiting_.load(std::memory_order_relaxed); }
  std::int64_t highWater() const { return high_water_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::int64_t> waiting_{0}, high_water_{0};
};

}  // namespace motorcade
