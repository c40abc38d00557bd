#include "backend/joint/joint_backend.hpp"

#include "backend/joint/joint_reader.hpp"
#include "backend/smoother/continuous_poses.hpp"
#include "backend/smoother/settling.hpp"

namespace motorcade {
namespace {

constexpr int kCovarianceLagFrames = 10;  // final covariances are taken so much later; what comes after adds little

}  // namespace

class JointBackend::Estimator {
 public:
  Estimator(const Params& params, const StereoCamera& camera)
      : params_(requireValid(params)),
        graph_(params_, camera),
        reader_(graph_),
        continuous_(params.online_correction_s),
        settling_(params.settling_s) {}

  EstimatesPtr add(const FrameMeasurements& measurements) {
    graph_.add(measurements);
    Estimates estimates{.online = {}, .finals = {}, .counters = {}, .problems = graph_.problems()};
    if (params_.compute_covariances) {
      if (const auto settled = lagged()) graph_.keep(*settled, reader_.covariances(*settled));
      graph_.keep(measurements.frame, reader_.covariances(measurements.frame));
    }
    estimates.online = reader_.read(measurements.frame);
    continuous_(estimates.online, {.camera = [this](FrameId frame) { return earlierPose(frame); },
                                   .object = [this](TrackId id, FrameId frame) { return earlierPose(id, frame); }});
    for (const FrameId frame : settling_(graph_.frames())) estimates.settled.push_back(reader_.read(frame));
    while (params_.window_frames > 0 && graph_.frames().size() > static_cast<std::size_t>(params_.window_frames)) {
      estimates.finals.push_back(reader_.read(graph_.frames().begin()->first));
      graph_.retireOldest();
    }
    estimates.counters = graph_.solver().counters();
    estimates.counters.disparity_offset_px = graph_.offset_px();
    estimates.counters.disparity_offset_sigma_px = graph_.offsetSigma_px();
    return std::make_shared<const Estimates>(std::move(estimates));
  }

  std::vector<FrameEstimate> finish() {
    std::vector<FrameEstimate> finals;
    if (graph_.frames().empty()) return finals;
    graph_.converge();
    int left = static_cast<int>(graph_.frames().size());
    for (const auto& [frame, camera] : graph_.frames()) {
      if (params_.compute_covariances && left-- <= kCovarianceLagFrames) graph_.keep(frame, reader_.covariances(frame));
      finals.push_back(reader_.read(frame));
    }
    return finals;
  }

 private:
  /// The frame whose final covariances are due.
  std::optional<FrameId> lagged() const {
    auto it = graph_.frames().rbegin();
    for (int i = 0; i < kCovarianceLagFrames; ++i)
      if (it == graph_.frames().rend() || ++it == graph_.frames().rend()) return std::nullopt;
    return it->first;
  }

  std::optional<SE3> earlierPose(FrameId frame) const {
    const auto camera = graph_.frames().find(frame);
    if (camera == graph_.frames().end()) return std::nullopt;
    return graph_.solver().pose(camera->second.x);
  }

  std::optional<SE3> earlierPose(TrackId track, FrameId frame) const {
    const auto object = graph_.objects().find(track);
    if (object == graph_.objects().end() || !object->second.records.contains(frame)) return std::nullopt;
    if (!graph_.frames().contains(frame)) return std::nullopt;
    return graph_.objectPose(object->second, frame);
  }

  Params params_;
  JointGraph graph_;
  JointReader reader_;
  ContinuousPoses continuous_;
  Settling settling_;
};

JointBackend::JointBackend(const Params& params, const StereoCamera& camera)
    : estimator_(std::make_unique<Estimator>(params, camera)) {}
JointBackend::~JointBackend() = default;

EstimatesPtr JointBackend::operator()(const FrameMeasurementsPtr& measurements) {
  return estimator_->add(*measurements);
}
std::vector<FrameEstimate> JointBackend::finish() { return estimator_->finish(); }

}  // namespace motorcade
