#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace motorcade {

/// Text of an event, made once for all viewers.
using EventText = std::shared_ptr<const std::string>;

/// The pages that follow a run. Each has a mailbox for one event, the newest. A slow viewer loses events and delays
/// neither other viewers nor the publisher. Any thread may call.
class Viewers {
 public:
  static constexpr std::size_t kMost = 8;

  /// One viewer's seat, which is given back with its last owner.
  class Seat {
   public:
    explicit Seat(Viewers& viewers) : viewers_(viewers) {}
    ~Seat();
    Seat(const Seat&) = delete;
    Seat& operator=(const Seat&) = delete;

    /// Waits for the newest event not yet taken. Null when none came within `patience`, or when all were taken and no
    /// further one comes.
    EventText next(std::chrono::milliseconds patience);
    /// True when no further event comes and all were taken.
    bool over() const;
    /// Events that were replaced by newer ones before they were taken.
    std::int64_t missed() const;

   private:
    friend class Viewers;
    Viewers& viewers_;
    EventText newest_;
    std::int64_t missed_ = 0;
  };

  /// Null when all seats are taken, or the show is over.
  std::shared_ptr<Seat> admit();
  void publish(const EventText& event);
  /// Ends all waits; no further event comes.
  void close();

  /// Waits for nobody.
  std::size_t count() const { return count_.load(std::memory_order_relaxed); }
  /// Time since the last viewer left; zero while one is there.
  std::chrono::steady_clock::duration absence() const;

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Seat*> seats_;
  std::atomic<std::size_t> count_{0};
  EventText last_;
  bool closed_ = false;
  std::chrono::steady_clock::time_point last_left_ = std::chrono::steady_clock::now();
};

}  // namespace motorcade
