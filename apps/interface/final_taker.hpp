#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "motorcade/motorcade.hpp"

namespace motorcade {

/// The callback for finals, and the one thread that calls it. No final is queued: the thread waits until the callback
/// returns.
class FinalTaker {
 public:
  using Taker = std::function<void(Result)>;

  /// Directs finals to this callback, or to nobody if it is empty; for any thread. On return the previous callback has
  /// returned, unless it is the caller.
  void handTo(Taker taker);
  bool isThere() const;
  /// The thread that calls it. Throws what the callback throws.
  void give(Result final);

 private:
  class Handing;
  mutable std::mutex mutex_;
  std::condition_variable returned_;
  std::shared_ptr<const Taker> taker_;
  std::thread::id handing_;  // that is in the callback
};

}  // namespace motorcade
