#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>

#include "motorcade/motorcade.hpp"

namespace motorcade {

/// Results between a tracker and whoever takes them, or on their way to a callback. Bounded: in live the oldest gives
/// way; in replay the producer waits for takers (`waitForRoom`).
class ResultQueue {
 public:
  static constexpr std::size_t kMost = 256;
  using Taker = std::function<void(Result)>;

  /// Tracker: a result; gives back the callback that is to take it where there is one.
  Taker put(Result& result);
  /// Tracker: none comes after those that are there.
  void close();

  /// Producer of pairs: one more is under way; waits until less than `kMost` results are or wait, false when nobody
  /// took one in time.
  bool waitForRoom(std::chrono::milliseconds patience);
  /// Of that pair no result comes.
  void giveUpRoom();

  std::optional<Result> poll();
  std::optional<Result> wait(std::chrono::milliseconds timeout);
  bool done() const;
  void handTo(Taker taker);

  std::int64_t given() const;
  std::int64_t untaken() const;

 private:
  std::optional<Result> take();

  mutable std::mutex mutex_;
  std::condition_variable came_, went_;
  std::deque<Result> results_;
  Taker taker_;
  bool closed_ = false;
  std::size_t under_way_ = 0;  // replay: pairs that were accepted, and whose result was not taken
  std::int64_t given_ = 0, untaken_ = 0;
};

}  // namespace motorcade
