#pragma once

#include <array>
#include <atomic>
#include <cstddef>

namespace motorcade {

/// Keeps idle objects behind atomic pointers. A thread that swaps one out owns it, so no thread ever waits for another.
/// The class owns nothing: its user takes out what is left before it ends.
template <class T>
class IdleSlots {
 public:
  /// Null when nothing is found; an object that is put back during the search may be missed.
  T* take() {
    for (auto& slot : slots_) {
      if (!slot.load(std::memory_order_relaxed)) continue;
      if (T* idle = slot.exchange(nullptr, std::memory_order_acquire)) return idle;
    }
    return nullptr;
  }
  /// False when all slots are taken.
  bool putBack(T* idle) {
    for (auto& slot : slots_) {
      T* empty = slot.load(std::memory_order_relaxed);
      if (!empty && slot.compare_exchange_strong(empty, idle, std::memory_order_release, std::memory_order_relaxed))
        return true;
    }
    return false;
  }

 private:
  static constexpr std::size_t kSlots = 64;  // more than the frames in flight, and few enough to search
  std::array<std::atomic<T*>, kSlots> slots_{};
};

}  // namespace motorcade
