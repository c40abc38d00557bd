#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace motorcade {

/// Bounded lock-free queue from one producer thread to one consumer thread.
/// Each side may wait for the other; `close` (from any thread) ends every wait. What was pushed before can be popped.
template <class T>
class SpscRing {
 public:
  /// `capacity` is rounded up to a power of two.
  explicit SpscRing(std::size_t capacity) : slots_(std::bit_ceil(capacity)), mask_(slots_.size() - 1) {
    assert(capacity > 0);
  }

  std::size_t capacity() const { return slots_.size(); }

  /// Producer: false, with `value` untouched, when the ring is full or closed.
  bool tryPush(T& value) {
    const auto tail = tail_.load(std::memory_order_relaxed);
    const auto head = head_.load(std::memory_order_acquire);
    if (closed() || tail - head == slots_.size()) return false;
    slots_[tail & mask_] = std::move(value);
    tail_.store(tail + 1, std::memory_order_release);
    high_water_ = std::max<std::uint64_t>(high_water_, tail + 1 - head);
    signal(pushed_);
    return true;
  }

  /// Producer: waits for room; false when the ring was closed instead.
  bool push(T value) { return waitForRoom() && tryPush(value); }

  /// Producer: waits until the next `tryPush` will succeed; false when the ring was closed instead.
  bool waitForRoom() const {
    for (;;) {
      const auto seen = popped_.load(std::memory_order_acquire);
      if (closed()) return false;
      if (tail_.load(std::memory_order_relaxed) - head_.load(std::memory_order_acquire) < slots_.size()) return true;
      popped_.wait(seen, std::memory_order_acquire);
    }
  }

  /// Consumer: empty when nothing is there.
  std::optional<T> tryPop() {
    const auto head = head_.load(std::memory_order_relaxed);
    if (head == tail_.load(std::memory_order_acquire)) return std::nullopt;
    std::optional<T> value(std::exchange(slots_[head & mask_], T{}));
    head_.store(head + 1, std::memory_order_release);
    signal(popped_);
    return value;
  }

  /// Consumer: waits for a value; empty when the ring is closed and drained.
  std::optional<T> pop() {
    for (;;) {
      const auto seen = pushed_.load(std::memory_order_acquire);
      const bool was_closed = closed();
      if (auto value = tryPop()) return value;
      if (was_closed) return std::nullopt;
      pushed_.wait(seen, std::memory_order_acquire);
    }
  }

  void close() {
    closed_.store(true, std::memory_order_release);
    signal(pushed_);
    signal(popped_);
  }
  bool closed() const { return closed_.load(std::memory_order_acquire); }

  /// Approximate number of values held; any thread may call.
  std::size_t size() const {
    const auto head = head_.load(std::memory_order_acquire);
    return std::min<std::size_t>(tail_.load(std::memory_order_acquire) - head, slots_.size());
  }
  /// Most values ever held at once. Read it from the producer or after it has ended.
  std::size_t highWater() const { return high_water_; }

 private:
  static void signal(std::atomic<std::uint32_t>& event) {
    event.fetch_add(1, std::memory_order_release);
    event.notify_one();
  }

  static constexpr std::size_t kCacheLine = 64;
  std::vector<T> slots_;
  std::size_t mask_;
  alignas(kCacheLine) std::atomic<std::uint64_t> head_{0};                // next slot to pop
  alignas(kCacheLine) std::atomic<std::uint64_t> tail_{0};                // next slot to push
  std::uint64_t high_water_ = 0;                                          // producer only
  alignas(kCacheLine) std::atomic<std::uint32_t> pushed_{0}, popped_{0};  // event counts to wait on
  std::atomic<bool> closed_{false};
};

}  // namespace motorcade
