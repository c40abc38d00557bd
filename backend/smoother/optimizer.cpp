#include "backend/smoother/optimizer.hpp"

#include <cmath>
#include <map>

#include "backend/smoother/estimate_reader.hpp"
#include "backend/smoother/trajectory_graph.hpp"

namespace motorcade {
namespace {

constexpr int kCovarianceLagFrames = 5;  // final covariances are taken so much later; what comes after adds little

/// Poses of objects as they are published. Each observation corrects the whole track; published as it is, a correction
/// would look like a motion of the object. So the published pose moves by the object's estimated motion since, and
/// corrections are added gradually.
class ContinuousPoses {
 public:
  explicit ContinuousPoses(double correction_s) : correction_s_(correction_s) {}

  /// Changes the objects' poses of the newest frame; `graph` says how they moved since they were published last.
  void operator()(FrameEstimate& online, const TrajectoryGraph& graph) {
    std::map<TrackId, Published> published;
    for (ObjectEstimate& object : online.objects) {
      const auto last = last_.find(object.track);
      if (last != last_.end()) object.T_world_body = continued(last->second, object, online, graph);
      published[object.track] = {online.frame, online.stamp, object.T_world_body};
    }
    last_ = std::move(published);
  }

 private:
  struct Published {
    FrameId frame;
    Timestamp stamp;
    SE3 T_world_body;
  };

  SE3 continued(const Published& last, const ObjectEstimate& object, const FrameEstimate& online,
                const TrajectoryGraph& graph) const {
    const ObjectTrack& track = graph.tracks().at(object.track);
    if (!(correction_s_ > 0) || !track.records.contains(last.frame) || !graph.frames().contains(last.frame))
      return object.T_world_body;
    const SE3 predicted = object.T_world_body * graph.objectPose(track, last.frame).inverse() * last.T_world_body;
    const double share = 1 - std::exp(-secondsBetween(last.stamp, online.stamp) / correction_s_);
    return (predicted * SE3::exp(share * (predicted.inverse() * object.T_world_body).log())).normalized();
  }

  double correction_s_;
  std::map<TrackId, Published> last_;
};

}  // namespace

class Optimizer::Smoother {
 public:
  explicit Smoother(const Params& params)
      : params_(params), graph_(params_), reader_(graph_), continuous_(params.online_correction_s) {}

  EstimatesPtr add(const FrameMeasurements& measurements) {
    graph_.add(measurements);
    Estimates estimates{.online = {}, .finals = {}, .counters = {}, .problems = graph_.problems()};
    if (params_.compute_covariances) {
      if (const auto settled = lagged()) keepCovariances(*settled);
      keepCovariances(measurements.frame);
    }
    estimates.online = reader_.read(measurements.frame);
    continuous_(estimates.online, graph_);
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
};

Optimizer::Optimizer(const Params& params) : smoother_(std::make_unique<Smoother>(requireValid(params))) {}
Optimizer::~Optimizer() = default;

EstimatesPtr Optimizer::operator()(const FrameMeasurementsPtr& measurements) { return smoother_->add(*measurements); }

std::vector<FrameEstimate> Optimizer::finish() { return smoother_->finish(); }

}  // namespace motorcade
