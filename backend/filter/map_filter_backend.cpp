#include "backend/filter/map_filter_backend.hpp"

#include <algorithm>
#include <map>

#include "backend/filter/filter_estimates.hpp"
#include "backend/motion/camera_path.hpp"
#include "core/se3.hpp"

namespace motorcade {

struct MapFilterBackend::State {
  Params params;
  CameraPath path;
  std::map<TrackId, ObjectFilter> filters;
  SolverCounters counters;

  void observe(const ObjectObservation& observation) {
    const auto* camera = path.find(observation.frame);
    if (!camera || !isFinite(observation.T_cam_body)) return;
    const SE3 T_world_body = camera->T_world_cam * observation.T_cam_body;
    const auto filter = filters.find(observation.track);
    if (filter == filters.end()) {
      if (observation.encounter_covariance.allFinite())
        filters.emplace(observation.track,
                        ObjectFilter(params, camera->stamp, T_world_body, observation.encounter_covariance));
      return;
    }
    filter->second.predict(camera->stamp);
    if (observation.state == ObjectState::kPredicted) return;
    if (const auto normalized = filter->second.correct(T_world_body, observation.encounter_covariance)) {
      counters.chi2 += 6 * *normalized;
      ++counters.factors;
    }
  }
};

MapFilterBackend::MapFilterBackend(const Params& params) : state_(std::make_unique<State>()) {
  state_->params = params;
}
MapFilterBackend::~MapFilterBackend() = default;

EstimatesPtr MapFilterBackend::operator()(const FrameMeasurementsPtr& measurements) {
  const FrameMeasurements& m = *measurements;
  state_->path.add(m);
  Estimates estimates{.online = cameraEstimate(m, state_->path), .finals = {}, .counters = {}};
  for (const ObjectObservation& observation : m.objects) {
    state_->observe(observation);
    const auto filter = state_->filters.find(observation.track);
    if (observation.frame == m.head.frame && filter != state_->filters.end())
      estimates.online.objects.push_back(objectEstimate(observation, filter->second));
  }
  std::ranges::sort(estimates.online.objects, {}, &ObjectEstimate::track);
  for (const TrackId track : m.ended) state_->filters.erase(track);
  ++state_->counters.updates;
  state_->counters.variables = static_cast<std::int64_t>(state_->filters.size());
  estimates.counters = state_->counters;
  estimates.finals = {estimates.online};
  return std::make_shared<const Estimates>(std::move(estimates));
}

std::vector<FrameEstimate> MapFilterBackend::finish() { return {}; }

}  // namespace motorcade
