#include "apps/interface/pair_watch.hpp"

#include <new>
#include <utility>

namespace motorcade {

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
