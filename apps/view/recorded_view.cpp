#include "apps/view/recorded_view.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <semaphore>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "apps/console/stop_signals.hpp"
#include "apps/latency/latency_report.hpp"
#include "apps/recorded/recorded_run.hpp"
#include "apps/view/page_json.hpp"
#include "apps/view/page_server.hpp"
#include "io/files/errors.hpp"
#include "io/files/json_text.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;
using FileJson = nlohmann::json;

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

ShownTiming timingOf(const FrameRow& row) {
  ShownTiming shown{.latency_ms = row.latency_ms, .decode_ms = row.decode_ms};
  for (std::size_t stage = 0; stage < kStageCount; ++stage) shown.stages_ms[stage] = row.stages[stage].work_ms;
  return shown;
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

std::map<std::int64_t, std::vector<std::string>> readOutlineLines(const fs::path& run_folder) {
  std::map<std::int64_t, std::vector<std::string>> outlines;
  const fs::path file = run_folder / "outlines.jsonl";
  if (!fs::exists(file)) return outlines;
  constexpr std::string_view kStart = R"({"frame":)";
  for (TextLine& line : readLines(file, LastLine::kDropIfCut))
    if (line.text.starts_with(kStart))
      outlines[std::strtoll(line.text.c_str() + kStart.size(), nullptr, 10)].push_back(std::move(line.text));
  return outlines;
}

ShownOutline outlineOf(const std::string& line) {
  const FileJson json = jsonOrDiscarded(line);
  if (!json.is_object() || !json.contains("track_id") || !json.contains("polygons")) return {};
  ShownOutline outline;
  try {
    outline.track = {json["track_id"].get<std::int64_t>()};
    for (const FileJson& polygon : json["polygons"]) {
      Polygon& corners = outline.polygons.emplace_back();
      for (const FileJson& corner : polygon) corners.emplace_back(corner.at(0).get<int>(), corner.at(1).get<int>());
    }
  } catch (const FileJson::exception&) {
    return {};
  }
  return outline;
}

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
  overview_json_ = toJson(RunOverview{.drive = drive_, .rows = rows_, .truth = truth_, .paced = run_.paced});
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
    shown.timing = timingOf(row->second);
  }
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

int runView(const ViewOptions& options) {
  const ListenAddress address = parseListenAddress(options.address, "--view");
  const RunFolder run = readRunFolder(options.run);
  const Sequence sequence = openSequenceOf(run, {options.sequence, options.fps_hz});
  RecordedView view(run, sequence);
  if (!options.against.empty()) {
    const RunFolder other = readRunFolder(options.against);
    requireSameDrive(other, sequence);
    view.compareWith(std::make_unique<RecordedView>(other, sequence, worldOfOther(run, other)));
  }
  StopSignals signals;
  Viewers viewers;
  const PageServer server(address, view, viewers);
  viewers.publish(std::make_shared<const std::string>(eventJson(view.snapshot(), "")));
  std::printf("%s  (end with Ctrl-C)\n", server.url().c_str());
  std::fflush(stdout);
  std::binary_semaphore asked_to_end(0);
  const auto watch = signals.watch([&asked_to_end] { asked_to_end.release(); });
  asked_to_end.acquire();
  return 0;
}

}  // namespace motorcade
