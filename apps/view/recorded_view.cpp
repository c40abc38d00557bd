#include "apps/view/recorded_view.hpp"

#include <algorithm>
#include <utility>

#include "apps/latency/latency_report.hpp"
#include "apps/recorded/recorded_run.hpp"
#include "apps/view/recorded_files.hpp"
#include "apps/view/run_overview.hpp"
#include "io/files/errors.hpp"

namespace motorcade {
namespace {

double rateOf(const std::vector<Timestamp>& stamps) {
  constexpr double kUsualRate_hz = 10;
  if (stamps.size() < 2) return kUsualRate_hz;
  return static_cast<double>(stamps.size() - 1) / secondsBetween(stamps.front(), stamps.back());
}

RecordedDrive moved(RecordedDrive drive, const SE3& T) {
  const auto turn = [&T](const Eigen::Matrix3d& C) -> Eigen::Matrix3d {
    return T.rotation() * C * T.rotation().transpose();
  };
  for (SE3& pose : drive.T_world_cam) pose = T * pose;
  for (auto& [index, objects] : drive.objects)
    for (ObjectEstimate& object : objects) {
      object.T_world_body = T * object.T_world_body;
      object.velocity_world_mps = T.rotation() * object.velocity_world_mps;
      if (object.velocity_covariance) object.velocity_covariance = turn(*object.velocity_covariance);
    }
  return drive;
}

std::optional<RunTruth> moved(std::optional<RunTruth> truth, const SE3& T) {
  if (!truth) return truth;
  for (SE3& pose : truth->on_path) pose = T * pose;
  for (ShownTruth& frame : truth->frames) {
    frame.T_world_cam = T * frame.T_world_cam;
    for (ShownTrueObject& object : frame.objects) object.T_world_object = T * object.T_world_object;
  }
  return truth;
}

}  // namespace

SE3 worldOfOther(const RunFolder& run, const RunFolder& other) {
  const std::vector<SE3>&ours = fullerTrajectories(run).camera, &theirs = fullerTrajectories(other).camera;
  const std::int64_t first = std::max(run.first_frame, other.first_frame);
  const std::int64_t in_ours = first - run.first_frame, in_theirs = first - other.first_frame;
  if (in_ours >= std::ssize(ours) || in_theirs >= std::ssize(theirs))
    throw InputError(other.folder.string() + ": has no frame in common with " + run.folder.string());
  if (run.first_frame == other.first_frame) return {};
  return ours[static_cast<std::size_t>(in_ours)] * theirs[static_cast<std::size_t>(in_theirs)].inverse();
}

RecordedView::RecordedView(const RunFolder& run, const Sequence& sequence, const SE3& T_shown_run)
    : drive_(moved(recordedDrive(run, sequence), T_shown_run)),
      truth_(moved(readRunTruth(run, sequence), T_shown_run)),
      timings_(readTimings(run.folder)),
      outlines_(readOutlineLines(run.folder)),
      pictures_(sequence) {
  if (drive_.T_world_cam.empty())
    throw InputError((run.folder / "camera_final.txt").string() + ": holds no pose: the run ended before its first");
  describe(run, sequence);
  countFrames(run);
  for (std::int64_t frame = run_.first_frame; frame < run_.end_frame; ++frame) {
    FrameEstimate estimate = shown(frame, FrameDetail::kWithoutImageParts).estimate;
    if (const auto road = roadUnder(estimate)) roads_[frame] = *road;
  }
  overview_json_ =
      toJson(RunOverview{.drive = drive_, .rows = rows_, .timings = timings_, .truth = truth_, .paced = run_.paced});
}

void RecordedView::describe(const RunFolder& run, const Sequence& sequence) {
  run_.name = sequence.folder.filename().string();
  run_.folder = run.folder.string();
  run_.recorded = true;
  run_.first_frame = drive_.first_frame;
  run_.end_frame = drive_.first_frame + std::ssize(drive_.T_world_cam);
  run_.first_stamp = drive_.stamps.front();
  run_.rate_hz = rateOf(drive_.stamps);
  run_.paced = wasPaced(run);
  run_.camera = drive_.camera;
}

void RecordedView::countFrames(const RunFolder& run) {
  for (const FrameRow& row : run.frames) {
    rows_[row.head.frame.value] = row;
    counts_.count(row.head.status);
    if (row.head.status != FrameStatus::kDropped) counts_.countTimes(row.latency_ms, processing_ms(row));
  }
}

void RecordedView::compareWith(std::unique_ptr<const RecordedView> other) {
  run_.against = other->run_.folder;
  against_ = std::move(other);
}

std::optional<ShownTruth> RecordedView::truthOf(std::int64_t frame) const {
  const auto index = static_cast<std::size_t>(frame - run_.first_frame);
  if (!truth_ || index >= truth_->frames.size()) return {};
  return truth_->frames[index];
}

RunSnapshot RecordedView::snapshot() const {
  RunSnapshot snapshot{.state = "recorded"};
  counts_.read(snapshot);
  return snapshot;
}

ShownFrame RecordedView::shown(std::int64_t frame, FrameDetail detail) const {
  const auto index = static_cast<std::size_t>(frame - run_.first_frame);
  ShownFrame shown;
  FrameEstimate& estimate = shown.estimate;
  estimate.head.frame = {frame};
  estimate.head.stamp = drive_.stamps[index];
  estimate.T_world_cam = drive_.T_world_cam[index];
  estimate.objects = drive_.objectsAt(index);
  if (const auto row = rows_.find(frame); row != rows_.end()) {
    estimate.head.status = row->second.head.status;
    estimate.head.cause = row->second.head.cause;
    estimate.head.segment = row->second.head.segment;
  }
  if (const auto timing = timings_.find(frame); timing != timings_.end()) shown.timing = timing->second;
  if (const auto road = roads_.find(frame); road != roads_.end()) shown.road = road->second;
  if (detail == FrameDetail::kWithoutImageParts) return shown;
  shown.truth = truthOf(frame);
  for (const ObjectPoint& point : drive_.pointsAt(index))
    if (point.uvd_px.z() > 0)
      shown.points.push_back(
          {point.track, point.uvd_px.head<2>(), estimate.T_world_cam * drive_.camera.triangulate(point.uvd_px)});
  if (const auto lines = outlines_.find(frame); lines != outlines_.end())
    for (const std::string& line : lines->second) shown.outlines.push_back(outlineOf(line));
  return shown;
}

std::string RecordedView::framesJson(std::int64_t from, std::size_t count) const {
  std::string json = R"({"frames":[)";
  const std::int64_t begin = std::max(from, run_.first_frame);
  for (std::int64_t frame = begin; has(frame) && frame < begin + static_cast<std::int64_t>(count); ++frame) {
    if (json.back() == '}') json += ',';
    json += toJson(shown(frame, FrameDetail::kWithoutImageParts), run_.first_stamp, FrameDetail::kWithoutImageParts);
  }
  return json + "]}";
}

std::string RecordedView::frameJson(std::int64_t frame) const {
  return has(frame) ? toJson(shown(frame, FrameDetail::kAll), run_.first_stamp) : "";
}

}  // namespace motorcade
