#pragma once

#include <atomic>

namespace motorcade {

/// Holds off a second thread that pushes at the same time.
class OneAtATime {
 public:
  explicit OneAtATime(std::atomic_flag& busy) : busy_(busy), entered_(!busy.test_and_set(std::memory_order_acquire)) {}
  ~OneAtATime() {
    if (entered_) busy_.clear(std::memory_order_release);
  }
  OneAtATime(const OneAtATime&) = delete;
  OneAtATime& operator=(const OneAtATime&) = delete;
  bool entered() const { return entered_; }

 private:
  std::atomic_flag& busy_;
  bool entered_;
};

/// A call that is under way. The tracker outlives it.
class Visit {
 public:
  explicit Visit(std::atomic<int>& visits) : visits_(visits) { ++visits_; }
  ~Visit() { --visits_; }
  Visit(const Visit&) = delete;
  Visit& operator=(const Visit&) = delete;

 private:
  std::atomic<int>& visits_;
};

}  // namespace motorcade
