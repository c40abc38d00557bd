#pragma once

#include <optional>

#include "backend/window/smoothing_window.hpp"

namespace motorcade {

/// How a rate of an object, its speed or its yaw rate, changes: its derivative is a random walk.
struct RateChange {
  /// The mean change is taken from so long before a frame to so long after it, as far as the object's frames go.
  double reach_s;
  /// Of the random walk, variance per second. A derivative of standard deviation s that lasts for a time tau (Singer
  /// 1970) has 2 s^2 / tau near by; on roads, tau is some 4 s.
  double density;
};
/// 1 m/s^2. Over 0.8 s the walk and the error of two speeds are about as large as each other.
inline constexpr RateChange kSpeedChange{.reach_s = 0.4, .density = 0.5};
/// 0.2 rad/s^2, as a turn into another street takes. A yaw rate is known better than that, so that the span is shorter.
inline constexpr RateChange kYawRateChange{.reach_s = 0.2, .density = 0.02};

/// The frames around one of an object's frames, or up to it, between which a rate's mean change is taken.
struct AccelerationSpan {
  const ObjectRecord *from, *to;
  double before_s, after_s;  // from `from` to the frame, and on to `to`
  double length_s() const { return before_s + after_s; }
  /// Variance of the mean change less the derivative in the frame, where that walks at random with density q:
  ///   q (before^3 + after^3) / (3 (before + after)^2)
  double walkVariance(double density) const;
};

/// Reaches the neighboring frames at least. Empty where the frame has no twist in the graph, or no neighbor has one.
/// Points into the track.
std::optional<AccelerationSpan> accelerationSpan(const ObjectTrack& track, FrameId frame, double reach_s);

}  // namespace motorcade
