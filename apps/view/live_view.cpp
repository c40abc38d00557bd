#include "apps/view/live_view.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <sys/resource.h>

#include "io/images/image_file.hpp"

namespace motorcade {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kResultsAhead = 64, kPicturesAhead = 16;
/// Time without viewers after which a held run goes on. A page that is loaded anew is away for a moment.
constexpr std::chrono::seconds kDeserted = 5s;
constexpr int kNice = 10;

/// The objects' points of this frame, at the distances of their disparities.
std::vector<ShownPoint> pointsOf(const FrameMeasurements& measurements, const FrameEstimate& online,
                                 const StereoCamera& camera) {
  std::vector<ShownPoint> points;
  for (const ObjectObservation& seen : measurements.objects) {
    if (seen.frame != online.head.frame) continue;  // from before it was confirmed
    for (const PointMeasurement& point : seen.measured) {
      Eigen::Vector3d uvd_px = point.uvd_px.cast<double>();
      const Eigen::Vector2d uv_px = uvd_px.head<2>();
      uvd_px.z() += measurements.disparity_offset_px;
      if (uvd_px.z() > 0) points.push_back({seen.track, uv_px, online.T_world_cam * camera.triangulate(uvd_px)});
    }
  }
  return points;
}

std::vector<GroundCandidate> groundCandidates(const FrameMeasurements& measurements, const StereoCamera& camera) {
  std::vector<GroundCandidate> candidates;
  for (const PointMeasurement& point : measurements.at_rest) {
    Eigen::Vector3d uvd_px = point.uvd_px.cast<double>();
    uvd_px.z() += measurements.disparity_offset_px;
    if (!(uvd_px.z() > 1)) continue;
    candidates.push_back({camera.triangulate(uvd_px), static_cast<double>(point.sigma_px.z()) / uvd_px.z()});
  }
  return candidates;
}

ShownTiming timingOf(const FrameTiming& timing) {
  ShownTiming shown{.latency_ms = timing.latency_ms(), .decode_ms = timing.decode_ms};
  for (std::size_t stage = 0; stage < kStageCount; ++stage) shown.stages_ms[stage] = timing.stages[stage].duration_ms();
  return shown;
}

}  // namespace

LiveView::LiveView(const ListenAddress& address, const ShownRun& run, const Sequence& sequence)
    : run_(run),
      older_pictures_(sequence),
      gate_([this] { return viewers_.absence() > kDeserted; }),
      ground_(GroundPlaneEstimator::Params{}),
      pictures_(kPicturesAhead),
      results_(kResultsAhead),
      server_(std::make_unique<PageServer>(address, *this, viewers_)),
      thread_([this] { work(); }) {}

LiveView::~LiveView() {
  results_.close();
  thread_.join();
  {
    const std::scoped_lock lock(mutex_);
    ended_ = true;
  }
  publish();
  server_.reset();
}

void LiveView::frameEntered(const StereoFrame& frame) {
  if (viewers_.count() == 0 || frame.left.empty()) return;
  Picture picture{frame.head.frame, frame.left};
  pictures_.tryPush(picture);
}

void LiveView::frameLeft(const PipelineResult& result) {
  counts_.count(result);
  Result kept{.online = result.online, .masks = {}, .measurements = nullptr, .timing = result.timing};
  if (viewers_.count() > 0) {
    kept.masks = result.masks;
    kept.measurements = result.measurements;
  }
  results_.tryPush(kept);
}

void LiveView::followPipeline(std::function<PipelineState()> state) {
  const std::scoped_lock lock(mutex_);
  if (!state && state_) last_state_ = state_();
  state_ = std::move(state);
}

void LiveView::work() {
  ::setpriority(PRIO_PROCESS, 0, kNice);
  while (auto result = results_.pop()) {
    ShownFrame frame = shownOf(*result);
    {
      const std::scoped_lock lock(mutex_);
      history_.push_back(std::move(frame));
      if (history_.size() > kKeptFrames) history_.pop_front();
    }
    while (auto picture = pictures_.tryPop()) entered_.push_back(*std::move(picture));
    std::erase_if(entered_, [&](const Picture& picture) { return picture.frame < result->online.head.frame; });
    if (viewers_.count() == 0 || results_.size() > 0) continue;  // a newer one is shown at once
    encodePicture(result->online.head.frame);
    publish();
  }
}

ShownFrame LiveView::shownOf(const Result& result) {
  ShownFrame frame{.estimate = result.online, .timing = timingOf(result.timing)};
  if (!result.measurements) return frame;
  const StereoCamera& camera = run_.camera;
  for (const ObjectMask& mask : result.masks)
    frame.outlines.push_back({mask.track, outlinePolygons(mask, camera.width_px, camera.height_px)});
  frame.points = pointsOf(*result.measurements, result.online, camera);
  frame.road = roadOf(result);
  return frame;
}

/// Road plane from the points at rest, or from the objects before enough of those points lie on a road.
std::optional<RoadPlane> LiveView::roadOf(const Result& result) {
  constexpr std::size_t kFewPoints = 12;
  const auto candidates = groundCandidates(*result.measurements, run_.camera);
  const auto frame = static_cast<std::uint64_t>(result.online.head.frame.value);
  const GroundPlane plane = ground_(candidates, frame);
  const auto on_ground = std::ranges::count_if(
      candidates, [this](const GroundCandidate& candidate) { return ground_.isOnGround(candidate); });
  saw_road_ = saw_road_ || std::cmp_greater(on_ground, kFewPoints);
  if (!saw_road_) return roadUnder(result.online);
  const SE3& T = result.online.T_world_cam;
  return RoadPlane{.point_world = T * (plane.height_m * plane.normal_cam),
                   .up_world = -(T.rotation() * plane.normal_cam)};
}

/// Once for all viewers.
void LiveView::encodePicture(FrameId frame) {
  const auto found = std::ranges::find(entered_, frame, &Picture::frame);
  if (found == entered_.end()) return;
  auto jpeg = std::make_shared<const std::string>(encodeJpeg(found->left, kPageJpegQuality));
  const std::scoped_lock lock(mutex_);
  encoded_ = std::move(jpeg);
  encoded_frame_ = frame;
}

void LiveView::publish() {
  const RunSnapshot now = snapshot();
  std::string frame;
  {
    const std::scoped_lock lock(mutex_);
    if (!history_.empty()) frame = toJson(history_.back(), run_.first_stamp);
  }
  viewers_.publish(std::make_shared<const std::string>(eventJson(now, frame)));
}

RunSnapshot LiveView::snapshot() const {
  RunSnapshot snapshot;
  const std::scoped_lock lock(mutex_);
  const PipelineState state = state_ ? state_() : last_state_;
  snapshot.state = ended_ ? "ended" : gate_.paused() ? "paused" : "running";
  snapshot.received = state.received;
  snapshot.queues = state.queues;
  snapshot.viewers = static_cast<std::int64_t>(viewers_.count());
  counts_.read(snapshot);
  return snapshot;
}

std::string LiveView::framesJson(std::int64_t from, std::size_t count) const {
  std::vector<ShownFrame> frames;
  {
    const std::scoped_lock lock(mutex_);
    for (auto frame = std::ranges::lower_bound(history_, from, {},
                                               [](const ShownFrame& f) { return f.estimate.head.frame.value; });
         frame != history_.end() && frames.size() < count; ++frame)
      frames.push_back({.estimate = frame->estimate, .road = frame->road, .timing = frame->timing});
  }
  std::string json = R"({"frames":[)";
  for (const ShownFrame& frame : frames) {
    if (json.back() == '}') json += ',';
    json += toJson(frame, run_.first_stamp, FrameDetail::kWithoutImageParts);
  }
  return json + "]}";
}

std::string LiveView::frameJson(std::int64_t frame) const {
  const std::scoped_lock lock(mutex_);
  const auto found =
      std::ranges::find(history_, frame, [](const ShownFrame& f) { return f.estimate.head.frame.value; });
  return found == history_.end() ? "" : toJson(*found, run_.first_stamp);
}

std::shared_ptr<const std::string> LiveView::picture(std::int64_t frame) {
  {
    const std::scoped_lock lock(mutex_);
    if (encoded_ && encoded_frame_.value == frame) return encoded_;
  }
  return older_pictures_.jpeg(frame);
}

bool LiveView::control(const std::string& action) {
  if (!run_.can_pause) return false;
  if (action == "pause") gate_.pause();
  if (action == "resume") gate_.resume();
  if (action == "step") gate_.step();
  publish();
  return true;
}

}  // namespace motorcade
