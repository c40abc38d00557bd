#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "motorcade/motorcade.hpp"

namespace motorcade {

/// Results between a tracker and whoever takes them: by `poll` and `wait`, or through a callback. Bounded: in live the
/// oldest gives way, or with a callback the tracker waits for it; in replay the producer of pairs waits
/// (`waitForRoom`). Each member is for any thread.
class ResultQueue {
 public:
  static constexpr std::size_t kMost = 256;
  using Taker = std::function<void(Result)>;

  explicit ResultQueue(Tracker::Policy policy) : live_(policy == Tracker::Policy::kLive) {}

  /// Tracker: a result.
  void put(Result result);
  /// Tracker: none comes after those that are there.
  void close();
  /// Nobody takes results any more: ends every wait.
  void abandon();
  /// Results that wait, and those that still come, are untaken, and no `put` waits, until it is as new.
  void discard();
  /// The queue is as new, but for its counts and its callback.
  void restart();

  /// Producer of pairs: one more is under way; waits until less than `kMost` results are or wait, false when nobody
  /// took one in time. Does not wait after `endWaitsForRoom`.
  bool waitForRoom(std::chrono::milliseconds patience);
  void endWaitsForRoom();
  /// Gives the room back when no result of the pair comes.
  void giveUpRoom();

  std::optional<Result> poll();
  /// Also empty, and at once, when there is a callback.
  std::optional<Result> wait(std::chrono::milliseconds timeout);
  /// No result comes any more, and the callback has returned from the last one.
  bool done() const;

  /// Directs results, those that wait first, to the callback, or with an empty one back to `poll` and `wait`. On return
  /// the previous callback has returned, unless it is the caller.
  void handTo(Taker taker);
  /// The thread that calls callbacks: waits for a result and hands it to the callback. False when nobody takes results
  /// any more.
  bool handNext();

  std::int64_t given() const;
  std::int64_t untaken() const;

 private:
  class Handing;
  std::optional<Result> take();
  void dropAll();
  bool callbackIsBusy() const { return taker_ != nullptr && (!results_.empty() || handing_ != std::thread::id{}); }

  const bool live_;
  mutable std::mutex mutex_;
  std::condition_variable came_, went_;  // what `take`, or `put` and producers wait for
  std::deque<Result> results_;
  std::shared_ptr<const Taker> taker_;
  std::thread::id handing_;  // that is in the callback
  bool closed_ = false, abandoned_ = false, discarding_ = false, room_for_all_ = false;
  std::size_t under_way_ = 0;  // replay: pairs that were accepted, and whose result was not taken
  std::int64_t given_ = 0, untaken_ = 0;
};

}  // namespace motorcade
