#pragma once

#include <atomic>
#include <cstddef>

namespace motorcade {

/// Where a live frame waits until the frame before it has left the stages whose loops keep every worker busy: admitted
/// earlier it would only slow that one down and grow old, while in the mailbox the newest frame replaces it. Each
/// admitted frame gets that far, so that the wait ends.
class Entrance {
 public:
  /// Waits until `admitted` frames have passed.
  void waitUntilPassed(std::size_t admitted) const {
    for (auto passed = passed_.load(std::memory_order_acquire); passed < admitted;
         passed = passed_.load(std::memory_order_acquire))
      passed_.wait(passed, std::memory_order_acquire);
  }
  /// A frame has left those stages.
  void pass() {
    passed_.fetch_add(1, std::memory_order_release);
    passed_.notify_one();
  }

 private:
  std::atomic<std::size_t> passed_{0};
};

}  // namespace motorcade
