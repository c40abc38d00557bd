#include "backend/smoother/optimizer.hpp"

#include <cmath>
#include <map>

#include "backend/smoother/estimate_reader.hpp"
#include "backend/smoother/trajectory_graph.hpp"

namespace motorcade {
namespace {

/// Poses of objects as they are published. Each observation corrects the whole track; published as it is, a correction
/// would look like a motion of the object. So the published pose moves as the object is found to have moved since, and
/// corrections come in little by little.
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
      : params_(params), graph_(params_), reader_(graph_, params_), continuous_(params.online_correction_s) {}

  EstimatesPtr add(const FrameMeasurements& measurements) {
    graph_.add(measurements);
    Estimates estimates{.online = {}, .finals = {}, .counters = {}, .problems = graph_.problems()};
    if (params_.compute_covariances) {
      if (const auto settled = lagged()) reader_.refreshCovariances(*settled);
      reader_.refreshCovariances(measurements.frame);
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
      if (params_.compute_covariances && left-- <= params_.covariance_lag_frames) reader_.refreshCovariances(frame);
      finals.push_back(reader_.read(frame));
    }
    return finals;
  }

 private:
  /// The frame whose covariances are taken for good now.
  std::optional<FrameId> lagged() const {
    auto it = graph_.frames().rbegin();
    for (int i = 0; i < params_.covariance_lag_frames; ++i)
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

std::vector<Parameter> parametersOf(Optimizer::Params& params) {
  using Policy = Optimizer::RelinearizationPolicy;
  return {
      numberParameter("window_frames", params.window_frames, {0, 1e6},
                      "a frame is final when it leaves the window: longer is more exact, shorter comes earlier; 0 "
                      "keeps everything"),
      choiceParameter<Policy>("relinearization", params.policy, {{"every", Policy::kEveryN}, {"fluid", Policy::kFluid}},
                              "fluid relinearizes what is off; every N updates is the paper's way"),
      numberParameter("relinearize_every_updates", params.relinearize_every_updates, {1, 10000},
                      "of \"every\": fewer updates are more exact, more are faster"),
      numberParameter("budget_scalars", params.budget_scalars, {0, 1e6},
                      "bounds the work of an update, which then costs exactness for some updates; 0 sets no bound"),
      numberParameter("budget_ms", params.budget_ms, {0, 1000}, "the same in time, only with --live; 0 sets no bound"),
      switchParameter("compute_covariances", params.compute_covariances, "off saves time where nobody reads them"),
      numberParameter("online_correction_s", params.online_correction_s, {0, 10},
                      "longer is smoother online, shorter follows corrections sooner; 0 publishes poses as estimated"),
      switchParameter("factors.use_motion", params.use_motion, "motion of an object between successive frames"),
      switchParameter("factors.use_smoothness", params.use_smoothness, "vehicles keep their velocity"),
      switchParameter("factors.use_camera_encounter", params.use_camera_encounter,
                      "poses of objects seen from the camera"),
      switchParameter("factors.use_object_encounter", params.use_object_encounter,
                      "poses of objects relative to each other"),
      numberParameter("factors.object_correlation_s", params.object_correlation_s, {0, 30},
                      "how long an error of an object's points lasts: longer is smoother, shorter follows maneuvers")};
}

}  // namespace motorcade
