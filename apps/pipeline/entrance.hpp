#pragma once

#include <chrono>
#include <semaphore>

namespace motorcade {

/// Outcome of a push.
enum class Admission {
  kTaken,
  kReplacedOlder,  // taken, and one that still waited is dropped
  kLate,           // ignored: its id is not after the last one's
  kOutOfOrder,     // rejected: its time does not follow the last one's
  kTooClose,       // rejected: its time is so little after the last one's that its unit must be wrong
  kFarAhead,       // rejected: its time is far after the last one's, by a mistake or in a wrong unit
  kClosed,         // ignored: no further frame may come
};

/// True if a result will come, unless a newer frame replaces this one.
constexpr bool isTaken(Admission admission) {
  return admission == Admission::kTaken || admission == Admission::kReplacedOlder;
}

/// Holds a live frame until the previous one has left the stages whose loops keep every worker busy. Admitted earlier
/// it would only slow that one down and grow old, while in the mailbox the newest frame replaces it. Each admitted
/// frame leaves those stages, so that the wait ends.
class Entrance {
 public:
  /// Waits until all frames admitted so far have passed, or until `given_up`, which is asked now and then, says that
  /// they will not. Called once before each admission.
  template <class GivenUp>
  void waitForTurn(const GivenUp& given_up) {
    constexpr std::chrono::milliseconds kPatience(100);
    while (!turns_.try_acquire_for(kPatience))
      if (given_up()) return;
  }
  /// A frame has left those stages.
  void pass() { turns_.release(); }

 private:
  std::counting_semaphore<> turns_{1};
};

}  // namespace motorcade
