#include "backend/filter/filter_backend.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include "core/se3.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kKeptFrames = 64;  // past camera poses, for observations from before a confirmation

}  // namespace

struct FilterBackend::State {
  struct Camera {
    Timestamp stamp;
    SE3 T_world_cam, T_previous_now;
    Matrix6d odometry_covariance;
  };
  Params params;
  std::map<FrameId, Camera> cameras;
  std::map<TrackId, ObjectFilter> filters;
  double innovations = 0;
  SolverCounters counters;

  void addCamera(const FrameMeasurements& m) {
    const SE3 T_previous_now = isFinite(m.T_previous_now) ? m.T_previous_now : SE3{};
    const SE3 T_world_cam =
        cameras.empty() ? SE3{} : (cameras.rbegin()->second.T_world_cam * T_previous_now).normalized();
    cameras[m.frame] = {m.stamp, T_world_cam, T_previous_now, m.odometry_covariance};
    if (cameras.size() > kKeptFrames) cameras.erase(cameras.begin());
  }

  /// Chained over the last frames; the same frames' odometry is taken as independent.
  std::optional<Matrix6d> cameraCovariance(FrameId frame) const {
    const auto from = cameras.find(FrameId{frame.value - kCameraCovarianceFrames});
    if (from == cameras.end()) return std::nullopt;
    Matrix6d covariance = Matrix6d::Zero();
    for (auto it = std::next(from); it != cameras.end(); ++it) {
      const Matrix6d through = it->second.T_previous_now.inverse().adjoint();
      covariance = (through * covariance * through.transpose() + it->second.odometry_covariance).eval();
    }
    return covariance;
  }

  void observe(const ObjectObservation& observation) {
    const auto camera = cameras.find(observation.frame);
    if (camera == cameras.end() || !isFinite(observation.T_cam_body)) return;
    const SE3 T_world_body = camera->second.T_world_cam * observation.T_cam_body;
    const auto filter = filters.find(observation.track);
    if (filter == filters.end()) {
      if (observation.encounter_covariance.allFinite())
        filters.emplace(observation.track,
                        ObjectFilter(params, camera->second.stamp, T_world_body, observation.encounter_covariance));
      return;
    }
    filter->second.predict(camera->second.stamp);
    if (observation.state == ObjectState::kPredicted) return;
    if (const auto normalized = filter->second.correct(T_world_body, observation.encounter_covariance)) {
      innovations += *normalized;
      ++counters.factors;
    }
  }

  ObjectEstimate read(const ObjectObservation& observation) const {
    const ObjectFilter& filter = filters.at(observation.track);
    return {.track = observation.track,
            .state = observation.state,
            .T_world_body = filter.pose(),
            .velocity_world_mps = filter.velocityWorld_mps(),
            .speed_sigma_mps = filter.speedSigma_mps(),
            .points = observation.points,
            .box = observation.box,
            .covariance = filter.poseCovariance()};
  }
};

FilterBackend::FilterBackend(const Params& params) : state_(std::make_unique<State>()) { state_->params = params; }
FilterBackend::~FilterBackend() = default;

EstimatesPtr FilterBackend::operator()(const FrameMeasurementsPtr& measurements) {
  const FrameMeasurements& m = *measurements;
  state_->addCamera(m);
  Estimates estimates{.online = {.frame = m.frame,
                                 .stamp = m.stamp,
                                 .status = m.status,
                                 .T_world_cam = state_->cameras.at(m.frame).T_world_cam,
                                 .camera_covariance = state_->cameraCovariance(m.frame),
                                 .objects = {}},
                      .finals = {},
                      .counters = {}};
  for (const ObjectObservation& observation : m.objects) {
    state_->observe(observation);
    if (observation.frame == m.frame && state_->filters.contains(observation.track))
      estimates.online.objects.push_back(state_->read(observation));
  }
  std::ranges::sort(estimates.online.objects, {}, &ObjectEstimate::track);
  for (const TrackId track : m.ended) state_->filters.erase(track);
  ++state_->counters.updates;
  state_->counters.variables = static_cast<std::int64_t>(state_->filters.size());
  state_->counters.chi2 = 6 * state_->innovations;
  estimates.counters = state_->counters;
  estimates.finals = {estimates.online};
  return std::make_shared<const Estimates>(std::move(estimates));
}

std::vector<FrameEstimate> FilterBackend::finish() { return {}; }

double FilterBackend::meanNormalizedInnovation() const {
  return state_->counters.factors > 0 ? state_->innovations / static_cast<double>(state_->counters.factors) : 0;
}

}  // namespace motorcade
