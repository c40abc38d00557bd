#include "backend/window/window_backend.hpp"

#include "backend/window/continuous_poses.hpp"
#include "backend/window/estimate_reader.hpp"
#include "backend/window/settling.hpp"

namespace motorcade {
namespace {

constexpr int kCovarianceLagFrames = 10;  // final covariances are taken so much later; what comes after adds little

}  // namespace

class WindowBackend::Publisher {
 public:
  Publisher(std::unique_ptr<SmoothingWindow> window, const WindowParams& params)
      : params_(requireValid(params)),
        window_(std::move(window)),
        reader_(*window_, params.motion_frames),
        continuous_(params.online_correction_s),
        settling_(params.settling_s) {}

  EstimatesPtr add(const FrameMeasurements& measurements) {
    window_->add(measurements);
    Estimates estimates{.online = {}, .finals = {}, .counters = {}, .problems = window_->problems()};
    if (params_.compute_covariances) {
      if (const auto settled = lagged()) {
        keepCovariances(*settled);
        keepLookedBack(*settled);
      }
      keepCovariances(measurements.head.frame);
    }
    estimates.online = reader_.read(measurements.head.frame);
    continuous_(estimates.online,
                {.camera = [this](FrameId frame) { return earlierPose(frame); },
                 .object = [this](TrackId id, FrameId frame) { return earlierPose(id, frame); }},
                reader_.startOfMotion(measurements.head.frame));
    for (const FrameId frame : settling_(window_->frames())) estimates.settled.push_back(reader_.read(frame));
    while (params_.window_frames > 0 && window_->frames().size() > static_cast<std::size_t>(params_.window_frames)) {
      estimates.finals.push_back(reader_.read(window_->frames().begin()->first));
      window_->retireOldest();
    }
    estimates.counters = window_->counters();
    return std::make_shared<const Estimates>(std::move(estimates));
  }

  std::vector<FrameEstimate> finish() {
    std::vector<FrameEstimate> finals;
    if (window_->frames().empty()) return finals;
    window_->converge();
    int left = static_cast<int>(window_->frames().size());
    for (const auto& [frame, camera] : window_->frames()) {
      if (params_.compute_covariances && left-- <= kCovarianceLagFrames) keepCovariances(frame);
      finals.push_back(reader_.read(frame));
    }
    return finals;
  }

 private:
  void keepCovariances(FrameId frame) { window_->keep(frame, reader_.covariances(frame)); }

  /// Keeps covariances of records before `frame` that still have none, of an object that was found by looking back.
  void keepLookedBack(FrameId frame) {
    for (const auto& [id, track] : window_->tracks()) {
      for (auto it = track.records.find(frame); it != track.records.end() && it != track.records.begin();) {
        if ((--it)->second.covariances) break;
        const auto object = reader_.covariances(track, it->first);
        if (!object) break;
        window_->keep(it->first, {.camera = {}, .objects = {{id, *object}}});
      }
    }
  }

  /// The frame whose final covariances are due.
  std::optional<FrameId> lagged() const {
    auto it = window_->frames().rbegin();
    for (int i = 0; i < kCovarianceLagFrames; ++i)
      if (it == window_->frames().rend() || ++it == window_->frames().rend()) return std::nullopt;
    return it->first;
  }

  std::optional<SE3> earlierPose(FrameId frame) const {
    if (!window_->frames().contains(frame)) return std::nullopt;
    return window_->cameraPose(frame);
  }

  std::optional<SE3> earlierPose(TrackId id, FrameId frame) const {
    const auto track = window_->tracks().find(id);
    if (track == window_->tracks().end() || !track->second.records.contains(frame)) return std::nullopt;
    if (!window_->frames().contains(frame)) return std::nullopt;
    return window_->objectPose(track->second, frame);
  }

  WindowParams params_;
  std::unique_ptr<SmoothingWindow> window_;
  EstimateReader reader_;
  ContinuousPoses continuous_;
  Settling settling_;
};

WindowBackend::WindowBackend(std::unique_ptr<SmoothingWindow> window, const WindowParams& params)
    : publisher_(std::make_unique<Publisher>(std::move(window), params)) {}
WindowBackend::~WindowBackend() = default;

EstimatesPtr WindowBackend::operator()(const FrameMeasurementsPtr& measurements) {
  return publisher_->add(*measurements);
}
std::vector<FrameEstimate> WindowBackend::finish() { return publisher_->finish(); }

}  // namespace motorcade
