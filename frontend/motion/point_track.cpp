#include "frontend/motion/point_track.hpp"

#include <algorithm>

namespace motorcade {

const PointObservation* PointTrack::find(std::int64_t step) const {
  for (int i = count - 1; i >= 0; --i)
    if (observations[i].step == step) return &observations[i];
  return nullptr;
}

void PointTrack::add(const PointObservation& observation) {
  if (count == kCapacity) shorten(kCapacity - 1);
  observations[count++] = observation;
}

void PointTrack::shorten(int keep) {
  if (keep >= count) return;
  std::move(observations.begin() + (count - keep), observations.begin() + count, observations.begin());
  count = keep;
}

void CameraTrail::add(Timestamp stamp, const SE3& T_previous_now) {
  if (steps_.empty()) {
    steps_.push_back({0, stamp, SE3{}});
  } else {
    steps_.push_back({steps_.back().step + 1, stamp, (steps_.back().T_world_cam * T_previous_now).normalized()});
  }
  if (steps_.size() > PointTrack::kCapacity) steps_.erase(steps_.begin());
  const Step& now = steps_.back();
  relations_.clear();
  for (const auto& s : steps_)
    relations_.push_back({s.T_world_cam.inverse() * now.T_world_cam, secondsBetween(now.stamp, s.stamp)});
}

const CameraTrail::Relation* CameraTrail::find(std::int64_t step) const {
  if (steps_.empty() || step < steps_.front().step || step > steps_.back().step) return nullptr;
  return &relations_[step - steps_.front().step];
}

}  // namespace motorcade
