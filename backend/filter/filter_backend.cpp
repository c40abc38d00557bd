#include "backend/filter/filter_backend.hpp"

#include <map>
#include <optional>
#include <utility>

#include "backend/filter/filter_estimates.hpp"
#include "backend/motion/body_view.hpp"
#include "backend/motion/camera_path.hpp"
#include "core/se3.hpp"

namespace motorcade {

struct FilterBackend::State {
  /// State of an object at its last observation; predicted frames are read from a copy of the filter.
  struct Object {
    ObjectFilter filter;
    SE3 T_world_body;  // the end of the chain
    FrameId frame;
    std::vector<PointMeasurement> points;
    double disparity_offset_px;
  };
  Params params;
  StereoCamera camera;
  int motion_frames = kCameraCovarianceFrames;
  CameraPath path;
  std::map<TrackId, Object> objects;
  SolverCounters counters;

  /// The filter at the time of the observation; empty for an object that is not there yet.
  std::optional<ObjectFilter> observe(const ObjectObservation& seen, double disparity_offset_px) {
    const auto* at = path.find(seen.frame);
    const bool predicted = seen.state == ObjectState::kPredicted;
    const auto found = objects.find(seen.track);
    if (!at) return std::nullopt;
    if (found != objects.end()) {
      if (!predicted) follow(found->second, seen, *at, disparity_offset_px);
      ObjectFilter now = found->second.filter;
      now.predict(at->stamp);
      return now;
    }
    if (predicted || !isFinite(seen.T_cam_body) || !seen.encounter_covariance.allFinite()) return std::nullopt;
    const SE3 T_world_body = at->T_world_cam * seen.T_cam_body;
    const ObjectFilter filter(params, at->stamp, T_world_body, seen.encounter_covariance);
    objects.insert({seen.track, {filter, T_world_body, seen.frame, seen.measured, disparity_offset_px}});
    return filter;
  }

  void follow(Object& object, const ObjectObservation& seen, const CameraPath::Camera& at, double disparity_offset_px) {
    object.filter.predict(at.stamp);
    if (const auto motion = measureMotion(object, seen, at, disparity_offset_px)) {
      object.T_world_body = (object.T_world_body * motion->T_before_now).normalized();
      if (const auto normalized = object.filter.correct(object.T_world_body, motion->covariance)) {
        counters.chi2 += 6 * *normalized;
        ++counters.factors;
      }
    } else {
      object.T_world_body = object.filter.pose();  // the chain is broken, and goes on from where the object is expected
    }
    object.frame = seen.frame;
    object.points = seen.measured;
    object.disparity_offset_px = disparity_offset_px;
  }

  std::optional<ObjectObservation::Motion> measureMotion(const Object& object, const ObjectObservation& seen,
                                                         const CameraPath::Camera& at,
                                                         double disparity_offset_px) const {
    const auto* then = path.find(object.frame);
    if (!then) return std::nullopt;
    const BodyView before{object.frame, object.points, object.disparity_offset_px,
                          then->T_world_cam.inverse() * object.T_world_body};
    const BodyView now{seen.frame, seen.measured, disparity_offset_px, at.T_world_cam.inverse() * object.filter.pose()};
    return motionBetween(camera, before, now, path, [](PointId) { return true; });
  }
};

FilterBackend::FilterBackend(const Params& params, const StereoCamera& camera, int motion_frames)
    : state_(std::make_unique<State>()) {
  state_->params = params;
  state_->camera = camera;
  state_->motion_frames = motion_frames;
}
FilterBackend::~FilterBackend() = default;

EstimatesPtr FilterBackend::operator()(const FrameMeasurementsPtr& measurements) {
  return filtered(*state_, *measurements);
}

std::vector<FrameEstimate> FilterBackend::finish() { return {}; }

}  // namespace motorcade
