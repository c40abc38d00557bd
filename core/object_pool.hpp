#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <utility>

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

/// Faults in all pages of fresh memory at once: single faults are expensive, above all on virtual machines. On systems
/// that cannot do that, the pages come one after the other.
void populatePages(std::byte* begin, std::size_t bytes);

/// Hands out objects and takes them back unchanged when their last pointer is gone, so that their memory is used again.
/// Any thread may acquire and release objects. Neither takes a lock nor, once there are enough objects, the heap. An
/// object that is in use outlives the pool.
template <class T>
class ObjectPool {
 public:
  /// An object in the state in which it was released, or a new one.
  std::shared_ptr<T> acquire() {
    Place* idle = shelf_->idle.take();
    Place* place = idle ? idle : new Place;
    const auto keep = [](T*) {};
    return {&place->object, keep, InPlace<T>(shelf_, place)};
  }

 private:
  /// An object, and room for the counts of the shared pointers to it.
  struct Place {
    T object;
    alignas(std::max_align_t) std::array<std::byte, 64> counts;
  };
  struct Shelf {
    IdleSlots<Place> idle;
    ~Shelf() {
      while (Place* place = idle.take()) delete place;
    }
  };
  /// Lays the counts beside their object. The object is idle when they are released, which comes last.
  template <class Counts>
  struct InPlace {
    using value_type = Counts;
    std::shared_ptr<Shelf> shelf;
    Place* place;

    InPlace(std::shared_ptr<Shelf> s, Place* p) : shelf(std::move(s)), place(p) {}
    template <class Other>
    explicit(false) InPlace(const InPlace<Other>& other) : shelf(other.shelf), place(other.place) {}

    Counts* allocate(std::size_t) const {
      static_assert(sizeof(Counts) <= sizeof(Place::counts) && alignof(Counts) <= alignof(std::max_align_t));
      return reinterpret_cast<Counts*>(place->counts.data());
    }
    void deallocate(Counts*, std::size_t) const {
      if (!shelf->idle.putBack(place)) delete place;
    }
    template <class Other>
    bool operator==(const InPlace<Other>& other) const {
      return place == other.place;
    }
  };
  std::shared_ptr<Shelf> shelf_ = std::make_shared<Shelf>();
};

}  // namespace motorcade
