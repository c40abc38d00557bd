#pragma once

#include <cassert>

namespace motorcade {

/// Phase of an object: tentative -> confirmed <-> lost, and from each of them -> ended.
enum class Phase {
  kTentative,  // spawned from a moving component; not reported yet
  kConfirmed,  // reported, and measured in the newest frame
  kLost,       // reported, but not measured in the newest frame
  kEnded,      // removed at the end of the frame
};

/// Phase of an object and the counts that decide its transitions. Each frame either `observe`s or `miss`es it.
class LifeCycle {
 public:
  Phase phase() const { return phase_; }
  /// True when it was confirmed at some time, so that the back-end knows of it.
  bool reported() const { return reported_; }
  /// Frames with a measurement, that of its spawning included.
  int observations() const { return observations_; }
  /// Frames in a row without a measurement, up to the newest.
  int missed() const { return missed_; }

  void observe() {
    assert(phase_ != Phase::kEnded);
    ++observations_;
    missed_ = 0;
    if (phase_ == Phase::kLost) phase_ = Phase::kConfirmed;
  }
  void miss() {
    assert(phase_ != Phase::kEnded);
    ++missed_;
    if (phase_ == Phase::kConfirmed) phase_ = Phase::kLost;
  }
  /// Confirms the object; call once, after `observe`.
  void confirm() {
    assert(phase_ == Phase::kTentative && missed_ == 0);
    phase_ = Phase::kConfirmed;
    reported_ = true;
  }
  void end() { phase_ = Phase::kEnded; }

 private:
  Phase phase_ = Phase::kTentative;
  bool reported_ = false;
  int observations_ = 1;
  int missed_ = 0;
};

}  // namespace motorcade
