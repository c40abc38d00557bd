#include "apps/view/recorded_view.hpp"

#include <algorithm>

#include "apps/view/recorded_files.hpp"
#include "io/errors.hpp"

namespace motorcade {
namespace {

double rateOf(const std::vector<Timestamp>& stamps) {
  constexpr double kUsualRate_hz = 10;
  if (stamps.size() < 2) return kUsualRate_hz;
  return static_cast<double>(stamps.size() - 1) / secondsBetween(stamps.front(), stamps.back());
}

}  // namespace

RecordedView::RecordedView(const RunFolder& run, const Sequence& sequence)
    : drive_(recordedDrive(run, sequence)),
      timings_(readTimings(run.folder)),
      outlines_(readOutlineLines(run.folder)),
      pictures_(sequence) {
  if (drive_.T_world_cam.empty())
    throw InputError((run.folder / "camera_final.txt").string() + ": holds no pose: the run ended before its first");
  run_.name = sequence.folder.filename().string();
  run_.folder = run.folder.string();
  run_.recorded = true;
  run_.first_frame = drive_.first_frame;
  run_.end_frame = drive_.first_frame + std::ssize(drive_.T_world_cam);
  run_.first_stamp = drive_.stamps.front();
  run_.rate_hz = rateOf(drive_.stamps);
  run_.camera = drive_.camera;
  for (const FrameRow& row : run.frames) {
    rows_[row.frame.value] = row;
    counts_.count(row.status);
    if (row.status != FrameStatus::kDropped) counts_.countLatency(row.latency_ms);
  }
  for (std::int64_t frame = run_.first_frame; frame < run_.end_frame; ++frame) {
    FrameEstimate estimate = shown(frame, FrameDetail::kWithoutImageParts).estimate;
    if (const auto road = roadUnder(estimate)) roads_[frame] = *road;
  }
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
  estimate.frame = {frame};
  estimate.stamp = drive_.stamps[index];
  estimate.T_world_cam = drive_.T_world_cam[index];
  estimate.objects = drive_.objectsAt(index);
  if (const auto row = rows_.find(frame); row != rows_.end()) {
    estimate.status = row->second.status;
    estimate.cause = row->second.cause;
    estimate.segment = row->second.segment;
  }
  if (const auto timing = timings_.find(frame); timing != timings_.end()) shown.timing = timing->second;
  if (const auto road = roads_.find(frame); road != roads_.end()) shown.road = road->second;
  if (detail == FrameDetail::kWithoutImageParts) return shown;
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
