#pragma once

#include <cstdint>
#include <optional>

#include "core/timestamp.hpp"

namespace motorcade {

/// The time of frames, which never goes back, whatever the camera's clock does. A frame whose time is not after the
/// previous frame's is out of order. So is one far ahead, unless the next one agrees. A few frames in a row before the
/// last one, but in order, show that the clock was set back. Times then go on from the last one, at the pace of the new
/// ones.
class FrameClock {
 public:
  /// Least jump of a frame that is far ahead: no motion can be followed over a longer time.
  static constexpr std::int64_t kFarAhead_ns = 10'000'000'000;
  /// Number of frames in a row before the last one that are refused. The next one is accepted.
  static constexpr int kRefused = 4;

  /// The time of a frame with this stamp of the camera; empty when it is out of order.
  std::optional<Timestamp> read(Timestamp stamp);
  /// True when the last refused frame was far ahead.
  bool refusedFarAhead() const { return refused_ahead_.has_value(); }
  /// Likely capture time of the frame that was refused last: one period after the frame before it.
  Timestamp expected() const { return expected_; }
  /// Offset from the camera's time to the frames' time. It is how far the clock was set back, time without frames
  /// aside.
  std::int64_t ahead_ns() const { return ahead_ns_; }

 private:
  bool isFarAhead(Timestamp stamp) const;
  bool goesOn(Timestamp stamp);
  Timestamp accept(Timestamp stamp);

  std::optional<Timestamp> last_;  // as the camera stamped it
  std::int64_t ahead_ns_ = 0, period_ns_ = 0;
  Timestamp expected_;
  std::optional<Timestamp> refused_ahead_;  // the frame before this one
  Timestamp first_refused_, last_refused_;
  int refused_ = 0;  // in a row, before the last one, with times in order
};

}  // namespace motorcade
