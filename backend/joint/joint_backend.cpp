#include "backend/joint/joint_backend.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "backend/joint/joint_graph.hpp"

namespace motorcade {

class JointBackend::Estimator {
 public:
  Estimator(const Params& params, const StereoCamera& camera) : params_(params), graph_(params_, camera) {}

  EstimatesPtr add(const FrameMeasurements& measurements) {
    graph_.add(measurements);
    Estimates estimates{.online = {}, .finals = {}, .counters = {}, .problems = graph_.problems()};
    if (getenv("JOINT_LOG"))
      std::fprintf(stderr, "%ld offset %.4f +- %.4f at_rest %zu objects %zu chi2 %.1f problems %zu\n", measurements.frame.value,
                   graph_.offset_px(), graph_.offsetSigma_px(), measurements.at_rest.size(),
                   measurements.objects.size(), graph_.solver().counters().chi2, graph_.problems().size());
    estimates.online = read(measurements.frame);
    while (params_.window_frames > 0 && graph_.frames().size() > static_cast<std::size_t>(params_.window_frames)) {
      estimates.finals.push_back(read(graph_.frames().begin()->first));
      graph_.retireOldest();
    }
    estimates.counters = graph_.solver().counters();
    return std::make_shared<const Estimates>(std::move(estimates));
  }

  std::vector<FrameEstimate> finish() {
    std::vector<FrameEstimate> finals;
    if (graph_.frames().empty()) return finals;
    if (!getenv("JOINT_NOCONV")) graph_.converge();
    for (const auto& [frame, camera] : graph_.frames()) finals.push_back(read(frame));
    return finals;
  }

 private:
  FrameEstimate read(FrameId frame) const {
    const JointCamera& camera = graph_.frames().at(frame);
    FrameEstimate estimate{.frame = frame,
                           .stamp = camera.stamp,
                           .status = camera.status,
                           .T_world_cam = graph_.solver().pose(camera.x).normalized(),
                           .camera_covariance = camera.covariance,
                           .objects = {}};
    for (const auto& [id, object] : graph_.objects())
      if (object.records.contains(frame)) estimate.objects.push_back(readObject(id, object, frame));
    return estimate;
  }

  ObjectEstimate readObject(TrackId id, const JointObject& object, FrameId frame) const {
    constexpr double kUnknownSpeedSigma_mps = 10.0;  // of a single observation
    const JointRecord& record = object.records.at(frame);
    return {.track = id,
            .state = record.seen.state,
            .T_world_body = graph_.objectPose(object, frame),
            .velocity_world_mps = graph_.objectVelocity_mps(object, frame),
            .speed_sigma_mps = record.speed_sigma_mps.value_or(kUnknownSpeedSigma_mps),
            .points = record.seen.points,
            .box = record.seen.box,
            .covariance = record.covariance};
  }

  Params params_;
  JointGraph graph_;
};

JointBackend::JointBackend(const Params& params, const StereoCamera& camera)
    : estimator_(std::make_unique<Estimator>(params, camera)) {}
JointBackend::~JointBackend() = default;

EstimatesPtr JointBackend::operator()(const FrameMeasurementsPtr& measurements) {
  return estimator_->add(*measurements);
}
std::vector<FrameEstimate> JointBackend::finish() { return estimator_->finish(); }

}  // namespace motorcade
