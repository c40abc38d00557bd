#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <nlohmann/json.hpp>

#include "apps/latency/latency_report.hpp"
#include "apps/view/page_json.hpp"
#include "io/files/json_text.hpp"
#include "io/results/object_row.hpp"

namespace motorcade {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostLate = 10;
constexpr std::int64_t kLateApart = 5;  // frames: what is closer to a later one shows the same

/// Rounds away digits that nobody sees.
double shortened(double value, double digits = 1e3) { return std::round(value * digits) / digits; }

Json pathJson(const std::vector<SE3>& path) {
  Json json = Json::array();
  for (const SE3& pose : path)
    for (int axis = 0; axis < 3; ++axis) json.push_back(shortened(pose.translation()[axis]));
  return json;
}

Json spansJson(const std::vector<FrameSpan>& spans) {
  Json json = Json::array();
  for (const FrameSpan& span : spans) json.push_back({span.from, span.to});
  return json;
}

std::string_view statusOf(const FrameRow& row) {
  const bool degraded = row.head.status == FrameStatus::kGood && row.head.cause != FrameCause::kNone;
  return degraded ? "degraded" : statusName(row.head.status);
}

/// Frames that are not good; consecutive ones with the same cause are one mark.
Json marksJson(const RunOverview& overview) {
  Json marks = Json::array();
  for (const auto& [frame, row] : overview.rows) {
    const std::string_view status = statusOf(row), cause = causeName(row.head.cause);
    if (status == "good") continue;
    if (!marks.empty() && marks.back()["to"] == frame - 1 && marks.back()["status"] == status &&
        marks.back()["cause"] == cause)
      marks.back()["to"] = frame;
    else
      marks.push_back({{"from", frame}, {"to", frame}, {"status", status}, {"cause", cause}});
  }
  return marks;
}

/// Time of a frame: the latency since it was due if the run is paced, otherwise the processing time alone.
double timeOf_ms(const FrameRow& row, bool paced) { return paced ? row.latency_ms : processing_ms(row); }

/// Times of the frames that entered the pipeline.
std::vector<std::pair<std::int64_t, double>> times_ms(const RunOverview& overview) {
  std::vector<std::pair<std::int64_t, double>> times;
  for (const auto& [frame, row] : overview.rows)
    if (row.head.status != FrameStatus::kDropped) times.emplace_back(frame, timeOf_ms(row, overview.paced));
  return times;
}

Json percentilesJson(const RunOverview& overview, const std::vector<std::pair<std::int64_t, double>>& times) {
  std::vector<double> all_ms;
  for (const auto& [frame, time_ms] : times) all_ms.push_back(time_ms);
  const Percentiles percentiles = percentilesOf(all_ms);
  Json stages = Json::array();
  for (std::size_t stage = 0; stage < kStageCount; ++stage) {
    std::vector<double> work_ms;
    for (const auto& [frame, time_ms] : times) work_ms.push_back(overview.rows.at(frame).stages[stage].work_ms);
    stages.push_back(shortened(percentilesOf(std::move(work_ms)).p95));
  }
  return {{"frames", times.size()},
          {"p50", shortened(percentiles.p50)},
          {"p95", shortened(percentiles.p95)},
          {"p99", shortened(percentiles.p99)},
          {"max", shortened(percentiles.max)},
          {"stages_p95", stages}};
}

/// A value for each frame of the run; null where there is none.
Json perFrame(const RunOverview& overview, const std::vector<std::pair<std::int64_t, double>>& values, double digits) {
  std::vector<Json> json(overview.drive.T_world_cam.size());
  for (const auto& [frame, value] : values) {
    const std::int64_t index = frame - overview.drive.first_frame;
    if (index >= 0 && std::cmp_less(index, json.size()))
      json[static_cast<std::size_t>(index)] = shortened(value, digits);
  }
  return json;
}

Json tracksJson(const RunOverview& overview) {
  struct Track {
    std::vector<std::int64_t> frames;
    ObjectKind kind = ObjectKind::kUnknown;
  };
  std::map<TrackId, Track> tracks;
  for (const auto& [index, objects] : overview.drive.objects)
    for (const ObjectEstimate& object : objects) {
      Track& track = tracks[object.track];
      track.frames.push_back(overview.drive.first_frame + index);
      if (object.cuboid) track.kind = object.cuboid->kind;
    }
  Json json = Json::array();
  for (const auto& [id, track] : tracks)
    json.push_back({{"id", id.value},
                    {"color", trackColorText(id)},
                    {"kind", kindName(track.kind)},
                    {"spans", spansJson(spansOf(track.frames))}});
  return json;
}

Json truthOverview(const RunOverview& overview) {
  constexpr double kTenthOfMillimeter = 1e4;
  const RunTruth& truth = *overview.truth;
  std::vector<std::pair<std::int64_t, double>> position, step, motion;
  for (std::size_t i = 0; i < truth.frames.size(); ++i) {
    const ShownTruth& frame = truth.frames[i];
    const std::int64_t number = overview.drive.first_frame + static_cast<std::int64_t>(i);
    position.emplace_back(number, frame.position_m);
    if (i > 0) step.emplace_back(number, frame.step_m);
    double largest_m = -1;
    for (const ShownTrueObject& object : frame.objects) largest_m = std::max(largest_m, object.motion_m.value_or(-1));
    if (largest_m >= 0) motion.emplace_back(number, largest_m);
  }
  Json labels = Json::array();
  for (const AskedLabel& label : truth.labels) {
    Json tracks = Json::array();
    for (const TrackId track : label.tracks) tracks.push_back(track.value);
    labels.push_back(
        {{"id", label.label}, {"type", label.type}, {"spans", spansJson(label.spans)}, {"tracks", tracks}});
  }
  return {{"source", truth.source},
          {"object_source", truth.object_source},
          {"ate_m", shortened(truth.ate_m, kTenthOfMillimeter)},
          {"path", pathJson(truth.on_path)},
          {"position_m", perFrame(overview, position, kTenthOfMillimeter)},
          {"step_m", perFrame(overview, step, kTenthOfMillimeter)},
          {"motion_m", perFrame(overview, motion, kTenthOfMillimeter)},
          {"labels", labels}};
}

/// The first frames to look at, each with its reason.
Json worstJson(const RunOverview& overview, std::vector<std::pair<std::int64_t, double>> times) {
  constexpr double kTenthOfMillimeter = 1e4;
  Json worst{{"camera", Json::array()}, {"objects", Json::array()}, {"late", Json::array()}};
  std::ranges::stable_sort(times, std::greater(), [](const auto& time) { return time.second; });
  std::vector<std::int64_t> late;
  for (const auto& [frame, time_ms] : times) {
    if (late.size() == kMostLate) break;
    if (std::ranges::any_of(late, [&, of = frame](std::int64_t other) { return std::abs(other - of) < kLateApart; }))
      continue;
    late.push_back(frame);
    worst["late"].push_back({{"frame", frame}, {"ms", shortened(time_ms)}});
  }
  if (!overview.truth) return worst;
  for (const CameraFrameError& error : overview.truth->worst.camera)
    worst["camera"].push_back({{"frame", error.frame.value}, {"step_m", shortened(error.rpe_t_m, kTenthOfMillimeter)}});
  for (const ObjectFrameError& error : overview.truth->worst.objects)
    worst["objects"].push_back({{"frame", error.frame.value},
                                {"track", error.track.value},
                                {"label", error.label},
                                {"motion_m", shortened(error.me_t_m, kTenthOfMillimeter)}});
  return worst;
}

}  // namespace

std::string toJson(const RunOverview& overview) {
  const auto times = times_ms(overview);
  Json json{{"first_frame", overview.drive.first_frame},
            {"frames", overview.drive.T_world_cam.size()},
            {"marks", marksJson(overview)},
            {"timing", percentilesJson(overview, times)},
            {"time_ms", perFrame(overview, times, 1e2)},
            {"path", pathJson(overview.drive.T_world_cam)},
            {"tracks", tracksJson(overview)},
            {"worst", worstJson(overview, times)}};
  if (overview.truth) json["truth"] = truthOverview(overview);
  return jsonText(json);
}

}  // namespace motorcade
