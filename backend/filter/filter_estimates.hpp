#pragma once

#include <algorithm>
#include <memory>
#include <optional>

#include "backend/filter/object_filter.hpp"
#include "backend/motion/camera_path.hpp"
#include "core/messages.hpp"

namespace motorcade {

/// Estimate of a filtering back-end's camera, whose odometry is chained; objects are still missing. The covariance of
/// its motion spans `motion_frames`, at most those that the path keeps.
FrameEstimate cameraEstimate(const FrameMeasurements& measurements, const CameraPath& path, int motion_frames);
/// Estimate of an object, from a filter at the observation's time.
ObjectEstimate objectEstimate(const ObjectObservation& observation, const ObjectFilter& filter);

/// Processes one frame of a filtering back-end, whose estimates are final at once. `state` has a path, `motion_frames`,
/// objects by track, counters, and `observe`, which returns an object's filter at an observation's time, or nothing.
template <class State>
EstimatesPtr filtered(State& state, const FrameMeasurements& m) {
  state.path.add(m);
  FrameEstimate estimate = cameraEstimate(m, state.path, state.motion_frames);
  for (const ObjectObservation& seen : m.objects) {
    const std::optional<ObjectFilter> filter = state.observe(seen, m.disparity_offset_px);
    if (filter && seen.frame == m.head.frame) estimate.objects.push_back(objectEstimate(seen, *filter));
  }
  std::ranges::sort(estimate.objects, {}, &ObjectEstimate::track);
  for (const TrackId track : m.ended) state.objects.erase(track);
  ++state.counters.updates;
  state.counters.variables = static_cast<std::int64_t>(state.objects.size());
  return std::make_shared<const Estimates>(
      Estimates{.online = estimate, .finals = {estimate}, .counters = state.counters});
}

}  // namespace motorcade
