#pragma once

#include <chrono>
#include <semaphore>

namespace motorcade {

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
