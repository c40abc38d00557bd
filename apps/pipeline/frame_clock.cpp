#include "apps/pipeline/frame_clock.hpp"

#include <algorithm>

namespace motorcade {

std::optional<Timestamp> FrameClock::read(Timestamp stamp) {
  const bool after = !last_ || stamp > *last_;
  if (after && !isFarAhead(stamp)) return accept(stamp);
  expected_.ns += period_ns_;
  if (after) {
    refused_ahead_ = stamp;
    return std::nullopt;
  }
  if (!goesOn(stamp)) return std::nullopt;
  const std::int64_t period_ns = (last_refused_.ns - first_refused_.ns) / (refused_ - 1);
  const Timestamp time{last_->ns + ahead_ns_ + (stamp.ns - first_refused_.ns) + period_ns};
  ahead_ns_ = time.ns - stamp.ns;
  return accept(stamp);
}

bool FrameClock::isFarAhead(Timestamp stamp) const {
  if (!last_ || stamp.ns - last_->ns <= kFarAhead_ns) return false;
  return !refused_ahead_ || stamp <= *refused_ahead_;
}

/// True when enough frames were refused before this one, each after its predecessor.
bool FrameClock::goesOn(Timestamp stamp) {
  const bool in_order = refused_ > 0 && stamp > last_refused_;
  if (in_order && refused_ >= kRefused) return true;
  if (!in_order) first_refused_ = stamp;
  refused_ = in_order ? refused_ + 1 : 1;
  last_refused_ = stamp;
  return false;
}

Timestamp FrameClock::accept(Timestamp stamp) {
  constexpr std::int64_t kMaxPeriod_ns = 1'000'000'000;
  const Timestamp time{stamp.ns + ahead_ns_};
  if (last_ && refused_ == 0) period_ns_ = std::min(time.ns - expected_.ns, kMaxPeriod_ns);
  last_ = stamp;
  expected_ = time;
  refused_ = 0;
  refused_ahead_.reset();
  return time;
}

}  // namespace motorcade
