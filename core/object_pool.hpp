#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <utility>

namespace motorcade {

/// Hands out objects and takes them back when their last pointer is gone, as they are: what they hold on the heap serves again. Any thread
/// may acquire objects and let go of them, without locks. The objects outlive the pool while somebody holds them.
template <class T>
class ObjectPool {
 public:
  /// An object in the state in which it was let go of, or a new one.
  std::shared_ptr<T> acquire() {
    return {shelf_->take().release(), [shelf = shelf_](T* object) { shelf->putBack(std::unique_ptr<T>(object)); }};
  }

 private:
  /// Idle objects behind atomic pointers: whoever swaps one out owns it.
  class Shelf {
   public:
    ~Shelf() {
      while (takeIdle()) {
      }
    }
    std::unique_ptr<T> take() {
      auto idle = takeIdle();
      return idle ? std::move(idle) : std::make_unique<T>();
    }
    void putBack(std::unique_ptr<T> object) {
      for (auto& place : places_) {
        T* empty = nullptr;
        if (!place.compare_exchange_strong(empty, object.get(), std::memory_order_release, std::memory_order_relaxed)) continue;
        object.release();
        return;
      }
    }

   private:
    std::unique_ptr<T> takeIdle() {
      for (auto& place : places_)
        if (T* object = place.exchange(nullptr, std::memory_order_acquire)) return std::unique_ptr<T>(object);
      return nullptr;
    }
    std::array<std::atomic<T*>, 64> places_{};  // what finds none goes back to the heap
  };

  std::shared_ptr<Shelf> shelf_ = std::make_shared<Shelf>();
};

}  // namespace motorcade
