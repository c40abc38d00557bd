#pragma once

#include <optional>

#include "backend/window/smoothing_window.hpp"

namespace motorcade {

/// Change of an object's speed or yaw rate. The derivative of such a rate is a random walk.
struct RateChange {
  /// Time before and after a frame over which the mean change is taken, as far as the object's frames go.
  double reach_s;
  double deviation;  // standard deviation of the derivative
  /// Variance of the random walk per second, near by that of a derivative that lasts for some 4 s (Singer 1970).
  constexpr double density() const { return 2 * deviation * deviation / 4; }
};
/// Change of speed, in m/s^2. Over 0.8 s the walk and the error of two speeds are about equally large.
inline constexpr RateChange kSpeedChange{.reach_s = 0.4, .deviation = 1.0};
/// Change of yaw rate, in rad/s^2, as in a turn into another street. It is known better, so its span is shorter.
inline constexpr RateChange kYawRateChange{.reach_s = 0.2, .deviation = 0.2};

/// The frames around one of an object's frames, or up to it, between which a rate's mean change is taken.
struct AccelerationSpan {
  const ObjectRecord *from, *to;
  double before_s, after_s;  // from `from` to the frame, and on to `to`
  bool at_end;               // of what is known of the object: nothing comes before or after the span
  double length_s() const { return before_s + after_s; }
  /// Variance of the mean change minus the derivative in the frame, where that walks at random with density q:
  ///   q (before^3 + after^3) / (3 (before + after)^2)
  double walkVariance(double density) const;
};

/// Returns a span that reaches the neighboring frames at least; it points into the track. Empty where the frame has no
/// twist in the graph, or no neighbor has one.
std::optional<AccelerationSpan> accelerationSpan(const ObjectTrack& track, FrameId frame, double reach_s);

}  // namespace motorcade
