#pragma once

#include <memory>

#include "core/idle_places.hpp"

namespace motorcade {

/// Hands out objects and takes them back when their last pointer is gone, as they are: what they hold on the heap
/// serves again. Any thread may acquire objects and let go of them, without locks. The objects outlive the pool while
/// somebody holds them.
template <class T>
class ObjectPool {
 public:
  /// An object in the state in which it was let go of, or a new one.
  std::shared_ptr<T> acquire() {
    T* idle = shelf_->places.take();
    return {idle ? idle : new T, [shelf = shelf_](T* object) {
              if (!shelf->places.putBack(object)) delete object;
            }};
  }

 private:
  struct Shelf {
    IdlePlaces<T> places;
    ~Shelf() {
      while (T* idle = places.take()) delete idle;
    }
  };
  std::shared_ptr<Shelf> shelf_ = std::make_shared<Shelf>();
};

}  // namespace motorcade
