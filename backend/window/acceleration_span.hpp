#pragma once

#include <optional>

#include "backend/window/smoothing_window.hpp"

namespace motorcade {

/// The change of an object's speed or yaw rate. The derivative of such a rate is a random walk.
struct RateChange {
  /// The mean change is taken from so long before a frame to so long after it, as far as the object's frames go.
  double reach_s;
  double deviation;  // standard deviation of the derivative
  /// Of the random walk, variance per second: that of a derivative that lasts for some 4 s (Singer 1970), near by.
  constexpr double density() const { return 2 * deviation * deviation / 4; }
};
/// In m/s^2. Over 0.8 s the walk and the error of two speeds are about as large as each other.
inline constexpr RateChange kSpeedChange{.reach_s = 0.4, .deviation = 1.0};
/// In rad/s^2, as turning into another street takes. A yaw rate is known better than that: the span is shorter.
inline constexpr RateChange kYawRateChange{.reach_s = 0.2, .deviation = 0.2};

/// The frames around one of an object's frames, or up to it, between which a rate's mean change is taken.
struct AccelerationSpan {
  const ObjectRecord *from, *to;
  double before_s, after_s;  // from `from` to the frame, and on to `to`
  bool at_end;               // of what is known of the object: nothing comes before or after the span
  double length_s() const { return before_s + after_s; }
  /// Variance of the mean change less the derivative in the frame, where that walks at random with density q:
  ///   q (before^3 + after^3) / (3 (before + after)^2)
  double walkVariance(double density) const;
};

/// Reaches the neighboring frames at least. Empty where the frame has no twist in the graph, or no neighbor has one.
/// Points into the track.
std::optional<AccelerationSpan> accelerationSpan(const ObjectTrack& track, FrameId frame, double reach_s);

}  // namespace motorcade
