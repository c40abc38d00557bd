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

/// Results between a tracker and their consumer, who takes them by `poll` and `wait`, or through a callback. The queue
/// is bounded. In live the oldest result is dropped, or with a callback the tracker waits for it. In replay the
/// producer of pairs waits (`waitForRoom`). Each member is for any thread.
class ResultQueue {
 public:
  static constexpr std::size_t kMost = 256;
  using Taker = std::function<void(Result)>;

  explicit ResultQueue(Tracker::Policy policy) : live_(policy == Tracker::Policy::kLive) {}

  /// Tracker: a result.
  void put(Result result);
  /// Tracker: no further result comes.
  void close();
  /// Ends every wait, as nobody takes results any more.
  void abandon();
  /// Counts waiting and further results as untaken, and lets no `put` wait, until `restart`.
  void discard();
  /// Makes the queue as new, but for its counts and its callback.
  void restart();

  /// Producer of pairs: registers one more pair. Waits until fewer than `kMost` results are under way or waiting; false
  /// when nobody took one in time. Does not wait after `endWaitsForRoom`.
  bool waitForRoom(std::chrono::milliseconds patience);
  void endWaitsForRoom();
  /// Gives the room back when no result of the pair comes.
  void giveUpRoom();

  std::optional<Result> poll();
  /// Waits for a result. Returns empty at once when there is a callback.
  std::optional<Result> wait(std::chrono::milliseconds timeout);
  /// True when no further result comes, and the callback has returned from the last one.
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
