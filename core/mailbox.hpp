#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

namespace motorcade {

/// Hands the newest value from one producer thread to one consumer thread. Each side owns one of three slots, and the
/// third is exchanged. The producer never waits; an unread value is replaced by the next one.
template <class T>
class Mailbox {
 public:
  /// Producer: publishes `value` and returns the unread one that it replaced, if any. A value that comes during or
  /// after `close` remains for `tryTake`.
  std::optional<T> put(T value) {
    slots_[back_] = std::move(value);
    const auto before = middle_.exchange(static_cast<std::uint32_t>(back_) | kFresh, std::memory_order_acq_rel);
    back_ = before & kSlot;
    std::optional<T> unread;
    if (before & kFresh) {
      unread = std::exchange(slots_[back_], T{});
      overwritten_.fetch_add(1, std::memory_order_relaxed);
    }
    signal();
    return unread;
  }

  /// Consumer: the newest value, empty when there is none since the last call.
  std::optional<T> tryTake() {
    if (!(middle_.load(std::memory_order_relaxed) & kFresh)) return std::nullopt;
    front_ = middle_.exchange(static_cast<std::uint32_t>(front_), std::memory_order_acq_rel) & kSlot;
    return std::exchange(slots_[front_], T{});
  }

  /// Consumer: waits for a value; empty when the mailbox is closed and was read.
  std::optional<T> take() {
    for (;;) {
      const auto seen = events_.load(std::memory_order_acquire);
      const bool was_closed = closed();
      if (auto value = tryTake()) return value;
      if (was_closed) return std::nullopt;
      events_.wait(seen, std::memory_order_acquire);
    }
  }

  /// Any thread: ends every wait; the last value can still be taken.
  void close() {
    closed_.store(true, std::memory_order_release);
    signal();
  }
  bool closed() const { return closed_.load(std::memory_order_acquire); }

  /// Values that were replaced before they were read.
  std::int64_t overwritten() const { return overwritten_.load(std::memory_order_relaxed); }

 private:
  void signal() {
    events_.fetch_add(1, std::memory_order_release);
    events_.notify_one();
  }

  static constexpr std::uint32_t kSlot = 3, kFresh = 4;
  static constexpr std::size_t kCacheLine = 64;
  std::array<T, 3> slots_{};
  /// The slot that neither side owns, and whether it holds an unread value.
  alignas(kCacheLine) std::atomic<std::uint32_t> middle_{1};
  alignas(kCacheLine) std::size_t back_ = 0;  // producer only
  std::atomic<std::int64_t> overwritten_{0};
  alignas(kCacheLine) std::size_t front_ = 2;  // consumer only
  alignas(kCacheLine) std::atomic<std::uint32_t> events_{0};
  std::atomic<bool> closed_{false};
};

}  // namespace motorcade
