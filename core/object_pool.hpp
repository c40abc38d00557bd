#pragma once

#include <memory>

#include "core/idle_slots.hpp"

namespace motorcade {

/// Hands out objects and takes them back, unchanged, when their last pointer is gone, so that the memory they hold is
/// used again. Any thread may acquire and release objects, without locks. An object that is in use outlives the pool.
template <class T>
class ObjectPool {
 public:
  /// An object in the state in which it was released, or a new one.
  std::shared_ptr<T> acquire() {
    T* object = shelf_->idle.take();
    return {object ? object : new T, [shelf = shelf_](T* released) {
              if (!shelf->idle.putBack(released)) delete released;
            }};
  }

 private:
  struct Shelf {
    IdleSlots<T> idle;
    ~Shelf() {
      while (T* object = idle.take()) delete object;
    }
  };
  std::shared_ptr<Shelf> shelf_ = std::make_shared<Shelf>();
};

}  // namespace motorcade
