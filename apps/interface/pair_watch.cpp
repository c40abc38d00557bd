#include "apps/interface/pair_watch.hpp"

#include <algorithm>
#include <new>
#include <utility>

namespace motorcade {

const char* reasonOf(Admission admission) {
  switch (admission) {
    case Admission::kLate:
      return "its number is not after that of the pair before";
    case Admission::kOutOfOrder:
      return "its stamp does not follow that of the pair before";
    case Admission::kTooClose:
      return "its stamp is less than half a millisecond after that of the pair before; stamps are nanoseconds";
    case Admission::kFarAhead:
      return "its stamp is more than ten seconds after that of the pair before; stamps are nanoseconds";
    case Admission::kTaken:
    case Admission::kReplacedOlder:
    case Admission::kClosed:
      break;
  }
  return "";
}

/// Every second pair is accepted when pairs are far apart.
std::optional<std::string> StampDoubts::refused(Admission admission, std::int64_t stamp_ns) {
  constexpr int kRefused = 2, kSeveral = 3 * kRefused;
  if (admission != Admission::kTooClose && admission != Admission::kFarAhead) return std::nullopt;
  untimely_ = std::min(kSeveral, untimely_ + kRefused);
  if (untimely_ < kSeveral || std::exchange(told_, true)) return std::nullopt;
  return "pairs are rejected: the stamp " + std::to_string(stamp_ns) +
         (admission == Admission::kTooClose
              ? " is less than half a millisecond after that of the pair before, as the stamps before it were"
              : " is more than ten seconds after that of the pair before, as the stamps before it were") +
         "; stamp_ns must be in nanoseconds";
}

void StampDoubts::taken() { untimely_ = std::max(0, untimely_ - 1); }

Stages PairWatch::watched(Stages stages) {
  stages.optical_flow = [this, follow = std::move(stages.optical_flow)](const FeaturesPtr& features) {
    if (!features->frame->rejected()) {
      const std::scoped_lock lock(mutex_);
      waiting_.push_back(features->frame);
    }
    return follow(features);
  };
  return stages;
}

StereoFramePtr PairWatch::next(FrameId frame) {
  const std::scoped_lock lock(mutex_);
  if (waiting_.empty() || frame < waiting_.front()->head.frame) return nullptr;
  StereoFramePtr pair = std::move(waiting_.front());
  waiting_.pop_front();
  return pair;
}

void PairWatch::look(FrameId frame) {
  while (const StereoFramePtr pair = next(frame)) try {
      observe(*pair);
    } catch (const std::bad_alloc&) {  // a look less
    }
}

void PairWatch::observe(const StereoFrame& pair) {
  for (const RigFinding& found : watch_.observe(pair)) {
    tell(log_, LogLevel::kWarning, [&] { return "the rig: " + found.text(); });
    if (found.finding.worthless) problem_ = found.text();
  }
  if (!watch_.worthless()) problem_.clear();
}

}  // namespace motorcade
