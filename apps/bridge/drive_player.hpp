#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>

#include "motorcade/motorcade.hpp"

namespace motorcade {

/// Plays a recorded drive into a tracker, once or again and again.
class DrivePlayer {
 public:
  struct Pace {
    std::optional<double> speed;  // captured seconds per second; empty: as fast as the tracker takes the pairs
    bool live = false;            // pairs that are overtaken before they are read are left out
  };
  struct Counts {
    std::int64_t pushed = 0, rejected = 0;
    std::int64_t overtaken = 0;  // left out
  };
  /// Throws Error where the drive has no pair.
  explicit DrivePlayer(Recording& recording);

  /// Pushes all pairs in time, until asked to stop, then closes the tracker. Each pass has a tracker of its own. Its
  /// stamps continue where the last pass ended, a period later.
  void play(Tracker& tracker, const Pace& pace, const std::stop_token& stop);

  /// Pairs per captured second, 0 of a drive of one pair.
  double captureRate_hz() const;
  const Counts& counts() const { return counts_; }

 private:
  Recording& recording_;
  std::int64_t first_ns_, last_ns_, period_ns_;
  std::int64_t offset_ns_ = 0;  // of this pass's stamps
  Counts counts_{};
};

}  // namespace motorcade
