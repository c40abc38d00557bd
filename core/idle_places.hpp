#pragma once

#include <array>
#include <atomic>

namespace motorcade {

/// Keeps what is idle behind atomic pointers: whoever swaps one out owns it, so that no thread ever waits for another.
/// What is still there at the end is nobody's business here: its owner takes it out.
template <class T>
class IdlePlaces {
 public:
  /// Null when there is nothing; a search may miss what comes back behind it.
  T* take() {
    for (auto& place : places_) {
      if (!place.load(std::memory_order_relaxed)) continue;
      if (T* idle = place.exchange(nullptr, std::memory_order_acquire)) return idle;
    }
    return nullptr;
  }
  /// False when all places are taken.
  bool putBack(T* idle) {
    for (auto& place : places_) {
      T* empty = place.load(std::memory_order_relaxed);
      if (!empty && place.compare_exchange_strong(empty, idle, std::memory_order_release, std::memory_order_relaxed))
        return true;
    }
    return false;
  }

 private:
  std::array<std::atomic<T*>, 64> places_{};
};

}  // namespace motorcade
