#include "backend/window/acceleration_span.hpp"

#include <cmath>
#include <iterator>

namespace motorcade {
namespace {

constexpr double kStampTolerance_s = 5e-3;  // cameras are not that punctual

/// True if the span may go on from `next`, the neighbor of its end, which would then be `distance_s` from the frame.
bool goesOn(const ObjectRecord& next, bool is_neighbor_of_frame, double distance_s, double reach_s) {
  return next.twist.valid() && (is_neighbor_of_frame || distance_s <= reach_s + kStampTolerance_s);
}

}  // namespace

double AccelerationSpan::walkVariance(double density) const {
  return density * (std::pow(before_s, 3) + std::pow(after_s, 3)) / (3 * length_s() * length_s());
}

std::optional<AccelerationSpan> accelerationSpan(const ObjectTrack& track, FrameId frame, double reach_s) {
  const auto now = track.records.find(frame);
  if (now == track.records.end() || !now->second.twist.valid()) return std::nullopt;
  const Timestamp stamp = now->second.stamp;
  auto from = now, to = now;
  while (from != track.records.begin()) {
    const auto before = std::prev(from);
    if (!goesOn(before->second, from == now, secondsBetween(before->second.stamp, stamp), reach_s)) break;
    from = before;
  }
  for (auto after = std::next(now); after != track.records.end(); ++after) {
    if (!goesOn(after->second, to == now, secondsBetween(stamp, after->second.stamp), reach_s)) break;
    to = after;
  }
  const AccelerationSpan span{.from = &from->second,
                              .to = &to->second,
                              .before_s = secondsBetween(from->second.stamp, stamp),
                              .after_s = secondsBetween(stamp, to->second.stamp),
                              .at_end = from == track.records.begin() || std::next(to) == track.records.end()};
  if (!(span.length_s() > 0)) return std::nullopt;
  return span;
}

}  // namespace motorcade
