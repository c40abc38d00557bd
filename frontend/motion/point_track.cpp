#include "frontend/motion/point_track.hpp"

#include <algorithm>

namespace motorcade {

const PointObservation* PointTrack::find(std::int64_t step) const {
  for (int i = count - 1; i >= 0; --i)
    if (observations[i].step == step) return &observations[i];
  return nullptr;
}

StereoCorrespondence PointTrack::sinceThen(const PointObservation& then) const {
  return {then.uvd_px.cast<double>(), then.sigma_px.cast<double>(), newest().uvd_px.cast<double>(),
          newest().sigma_px.cast<double>()};
}

void PointTrack::restart(PointId new_point) {
  point = new_point;
  count = 0;
  flow.reset();
  p_static_cam.reset();
  label = PointLabel::kUnknown;
  ambiguity = 0;
}

void PointTrack::add(const PointObservation& observation) {
  if (count == kCapacity) {
    std::move(observations.begin() + 1, observations.end(), observations.begin());
    --count;
  }
  observations[count++] = observation;
}

void PointTrack::extend(const PointTrack& before, const PointObservation& observation) {
  restart(before.point);
  label = before.label;
  ambiguity = before.ambiguity;
  const int forgotten = before.count == kCapacity ? 1 : 0;
  std::copy(before.observations.begin() + forgotten, before.observations.begin() + before.count, observations.begin());
  count = before.count - forgotten;
  observations[count++] = observation;
}

}  // namespace motorcade
