#include "backend/smoother/optimizer.hpp"

#include "backend/smoother/continuous_poses.hpp"
#include "backend/smoother/estimate_reader.hpp"
#include "backend/smoother/settling.hpp"
#include "backend/smoother/trajectory_graph.hpp"

namespace motorcade {
namespace {

constexpr int kCovarianceLagFrames = 5;  // final covariances are taken so much later; what comes after adds little

}  // namespace

class Optimizer::Smoother {
 public:
  explicit Smoother(const Params& params)
      : params_(params),
        graph_(params_),
        reader_(graph_),
        continuous_(params.online_correction_s),
        settling_(params.settling_s) {}

  EstimatesPtr add(const FrameMeasurements& measurements) {
    graph_.add(measurements);
    Estimates estimates{.online = {}, .finals = {}, .counters = {}, .problems = graph_.problems()};
    if (params_.compute_covariances) {
      if (const auto settled = lagged()) keepCovariances(*settled);
      keepCovariances(measurements.frame);
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
    return std::make_shared<const Estimates>(std::move(estimates));
  }

  std::vector<FrameEstimate> finish() {
    if (graph_.frames().empty()) return {};
    graph_.converge();
    std::vector<FrameEstimate> finals;
    int left = static_cast<int>(graph_.frames().size());
    for (const auto& [frame, camera] : graph_.frames()) {
      if (params_.compute_covariances && left-- <= kCovarianceLagFrames) keepCovariances(frame);
      finals.push_back(reader_.read(frame));
    }
    return finals;
  }

 private:
  std::optional<SE3> earlierPose(FrameId frame) const {
    const auto camera = graph_.frames().find(frame);
    if (camera == graph_.frames().end()) return std::nullopt;
    return graph_.solver().pose(camera->second.x);
  }
  std::optional<SE3> earlierPose(TrackId id, FrameId frame) const {
    const ObjectTrack& track = graph_.tracks().at(id);
    if (!track.records.contains(frame) || !graph_.frames().contains(frame)) return std::nullopt;
    return graph_.objectPose(track, frame);
  }
  void keepCovariances(FrameId frame) { graph_.keep(frame, reader_.covariances(frame)); }

  /// The frame whose final covariances are due.
  std::optional<FrameId> lagged() const {
    auto it = graph_.frames().rbegin();
    for (int i = 0; i < kCovarianceLagFrames; ++i)
      if (it == graph_.frames().rend() || ++it == graph_.frames().rend()) return std::nullopt;
    return it->first;
  }

  Params params_;
  TrajectoryGraph graph_;
  EstimateReader reader_;
  ContinuousPoses continuous_;
  Settling settling_;
};

Optimizer::Optimizer(const Params& params) : smoother_(std::make_unique<Smoother>(requireValid(params))) {}
Optimizer::~Optimizer() = default;

EstimatesPtr Optimizer::operator()(const FrameMeasurementsPtr& measurements) { return smoother_->add(*measurements); }

std::vector<FrameEstimate> Optimizer::finish() { return smoother_->finish(); }

}  // namespace motorcade
