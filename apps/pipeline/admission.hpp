#pragma once

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

}  // namespace motorcade
