#include "backend/filter/map_filter_backend.hpp"

#include <map>
#include <optional>

#include "backend/filter/filter_estimates.hpp"
#include "backend/motion/camera_path.hpp"
#include "core/se3.hpp"

namespace motorcade {

struct MapFilterBackend::State {
  Params params;
  int motion_frames = kCameraCovarianceFrames;
  CameraPath path;
  std::map<TrackId, ObjectFilter> objects;
  SolverCounters counters;

  /// The object's filter at its last observation that could be used; empty for an object that is not there yet.
  std::optional<ObjectFilter> observe(const ObjectObservation& seen, double /*disparity_offset_px*/) {
    if (const auto* camera = path.find(seen.frame); camera && isFinite(seen.T_cam_body)) follow(seen, *camera);
    const auto object = objects.find(seen.track);
    return object == objects.end() ? std::nullopt : std::optional(object->second);
  }

  void follow(const ObjectObservation& seen, const CameraPath::Camera& camera) {
    const SE3 T_world_body = camera.T_world_cam * seen.T_cam_body;
    const auto object = objects.find(seen.track);
    if (object == objects.end()) {
      if (seen.encounter_covariance.allFinite())
        objects.emplace(seen.track, ObjectFilter(params, camera.stamp, T_world_body, seen.encounter_covariance));
      return;
    }
    object->second.predict(camera.stamp);
    if (seen.state == ObjectState::kPredicted) return;
    if (const auto normalized = object->second.correct(T_world_body, seen.encounter_covariance)) {
      counters.chi2 += 6 * *normalized;
      ++counters.factors;
    }
  }
};

MapFilterBackend::MapFilterBackend(const Params& params, int motion_frames) : state_(std::make_unique<State>()) {
  state_->params = params;
  state_->motion_frames = motion_frames;
}
MapFilterBackend::~MapFilterBackend() = default;

EstimatesPtr MapFilterBackend::operator()(const FrameMeasurementsPtr& measurements) {
  return filtered(*state_, *measurements);
}

std::vector<FrameEstimate> MapFilterBackend::finish() { return {}; }

}  // namespace motorcade
