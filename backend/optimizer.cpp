#include "backend/optimizer.hpp"

#include "backend/estimate_reader.hpp"
#include "backend/trajectory_graph.hpp"

namespace motorcade {

class Optimizer::Smoother {
 public:
  explicit Smoother(const Params& params) : params_(params), graph_(params_), reader_(graph_, params_) {}

  EstimatesPtr add(const FrameMeasurements& measurements) {
    graph_.add(measurements);
    Estimates estimates{.online = {}, .finals = {}, .counters = {}, .problems = graph_.problems()};
    if (params_.compute_covariances) {
      if (const auto settled = lagged()) reader_.refreshCovariances(*settled);
      reader_.refreshCovariances(measurements.frame);
    }
    estimates.online = reader_.read(measurements.frame);
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
};

Optimizer::Optimizer(const Params& params) : smoother_(std::make_unique<Smoother>(params)) {}
Optimizer::~Optimizer() = default;

EstimatesPtr Optimizer::operator()(const FrameMeasurementsPtr& measurements) { return smoother_->add(*measurements); }

std::vector<FrameEstimate> Optimizer::finish() { return smoother_->finish(); }

}  // namespace motorcade
