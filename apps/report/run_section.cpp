#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/evaluate/comparison/trajectory_error.hpp"
#include "apps/evaluate/report/report.hpp"
#include "apps/html/html_page.hpp"
#include "apps/html/svg_chart.hpp"
#include "apps/latency/latency_report.hpp"
#include "apps/recorded/recorded_run.hpp"
#include "apps/report/report_command.hpp"
#include "core/messages.hpp"
#include "io/files/json_text.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

using Json = nlohmann::json;

/// The summary, or an object without keys if it cannot be read.
Json summaryOf(const RunFolder& run) {
  Json json = jsonOrDiscarded(run.summary_json);
  return json.is_object() ? json : Json::object();
}

std::string card(const std::string& value, const std::string& label) {
  return "<div class=\"card\"><div class=\"value\">" + escaped(value) + "</div><div class=\"label\">" + escaped(label) +
         "</div></div>\n";
}

double lengthOf_m(const std::vector<SE3>& path) {
  double length_m = 0;
  for (std::size_t i = 1; i < path.size(); ++i) length_m += (path[i].translation() - path[i - 1].translation()).norm();
  return length_m;
}

std::size_t objectCount(const RecordedDrive& drive) {
  std::set<std::int64_t> tracks;
  for (const auto& [frame, objects] : drive.objects)
    for (const ObjectEstimate& object : objects) tracks.insert(object.track.value);
  return tracks.size();
}

std::string framesText(const ReportedRun& reported) {
  int unsure = 0;
  for (const FrameRow& row : reported.run.frames) unsure += row.head.status != FrameStatus::kGood;
  const std::size_t frames = reported.drive.T_world_cam.size();
  return unsure == 0 ? fmt::format("{} frames, all tracked", frames)
                     : fmt::format("{} frames, {} lost, rejected or dropped", frames, unsure);
}

/// Shows the latency if pairs were due at a pace. Otherwise it is mostly queueing.
std::string timeCard(const ReportedRun& reported, const Json& summary) {
  const auto latency = summary.find("latency_ms");
  if (wasPaced(reported.run) && latency != summary.end() && latency->contains("p99"))
    return card(fmt::format("{:.0f} ms", (*latency)["p99"].get<double>()), "latency, 99 of 100 frames");
  std::vector<double> work_ms;
  for (const FrameRow& row : reported.run.frames)
    if (row.head.status != FrameStatus::kDropped) work_ms.push_back(processing_ms(row));
  if (work_ms.empty()) return "";
  return card(fmt::format("{:.0f} ms", percentilesOf(std::move(work_ms)).p99),
              "processing of a pair, without waiting, 99 of 100 frames");
}

/// Empty if the cameras do not shake against each other, and for runs that do not record it.
std::string shakeCard(const Json& summary) {
  const double shake_px = summary.value(Json::json_pointer("/solver/disparity_shake_px"), 0.0);
  if (shake_px < kLeastToldShake_px) return "";
  return card(fmt::format("{:.2f} px", shake_px), "shake of the cameras against each other");
}

std::string cards(const ReportedRun& reported, const Json& summary) {
  std::string text = "<div class=\"cards\">\n";
  text += card(fmt::format("{:.0f} m", lengthOf_m(reported.drive.T_world_cam)), "driven");
  text += card(fmt::format("{}", objectCount(reported.drive)), "moving objects followed");
  if (reported.evaluation && reported.evaluation->final.camera) {
    const TrajectoryErrors& camera = *reported.evaluation->final.camera;
    text += card(fmt::format("{:.3f} m", camera.ate_m.rmse), "camera ATE (RMSE)");
    text += card(fmt::format("{:.1f} mm", 1e3 * camera.rpe_m.rmse), "camera RPE per frame");
    if (const auto& segments = reported.evaluation->final.camera_segments)
      text +=
          card(fmt::format("{:.2f} %", segments->all.translation_percent),
               segments->short_segments ? "camera error over 10 to 80 m" : "camera error over 100 to 800 m (KITTI)");
    const auto& near = reported.evaluation->final.detection.within_30m;
    if (near.labels > 0) text += card(fmt::format("{:.0f} %", 100 * near.recall()), "of movers within 30 m found");
  }
  text += shakeCard(summary);
  text += timeCard(reported, summary);
  if (summary.contains("cpu_s") && summary.contains("frames")) {
    const double frames = std::max(1.0, summary["frames"].value("received", 1.0));
    text +=
        card(fmt::format("{:.0f} ms", 1e3 * summary["cpu_s"].get<double>() / frames), "CPU per frame, with decoding");
  }
  return text + "</div>\n";
}

std::string versionRows(const Json& summary) {
  std::string rows;
  if (const auto versions = summary.find("versions"); versions != summary.end() && versions->is_object())
    for (const auto& [name, version] : versions->items())
      rows += "<tr><th>" + escaped(name) + "</th><td>" +
              escaped(version.is_string() ? version.get<std::string>() : "-") + "</td></tr>\n";
  return rows;
}

/// Distances of positions after SE(3) alignment, over time.
ChartLine errorsOf(const char* name, const char* color, std::vector<SE3> path, const RecordedDrive& drive) {
  ChartLine line{.name = name, .color = color};
  const std::size_t count = std::min({path.size(), drive.T_world_cam_true.size(), drive.stamps.size()});
  path.resize(count);
  const std::vector<SE3> truth(drive.T_world_cam_true.begin(),
                               drive.T_world_cam_true.begin() + static_cast<std::ptrdiff_t>(count));
  const SE3 aligned = alignPositions(path, truth);
  for (std::size_t i = 0; i < count; ++i)
    line.points.emplace_back(secondsBetween(drive.stamps.front(), drive.stamps[i]),
                             ((aligned * path[i]).translation() - truth[i].translation()).norm());
  return line;
}

std::string errorChart(const ReportedRun& reported) {
  const RecordedDrive& drive = reported.drive;
  if (drive.T_world_cam_true.size() < 3) return "";
  std::vector<ChartLine> lines;
  if (!reported.baseline.empty()) lines.push_back(errorsOf("baseline", "var(--ink)", reported.baseline, drive));
  lines.push_back(errorsOf("online", "var(--muted)", reported.run.online.camera, drive));
  lines.push_back(errorsOf("final", "var(--line1)", drive.T_world_cam, drive));
  return chartFigure(lineChart({.x = "s", .y = "camera position error, m", .wide = true}, lines),
                     "How far the camera's path is from the truth, each moved onto it as a whole (SE(3) alignment).");
}

constexpr std::size_t kHistogramBars = 40, kTimelineBars = 150;

std::vector<FrameRow> enteredRows(const RunFolder& run) {
  std::vector<FrameRow> rows = run.frames;
  std::erase_if(rows, [](const FrameRow& row) { return row.head.status == FrameStatus::kDropped; });
  return rows;
}

/// Histogram of latencies if they are `paced`, which count from when a pair was due. Otherwise latencies are mostly
/// waiting, and it shows the stages' work.
std::string histogram(const std::vector<FrameRow>& rows, bool paced) {
  const auto time_ms = [paced](const FrameRow& row) { return paced ? row.latency_ms : processing_ms(row); };
  double longest_ms = 0;
  for (const FrameRow& row : rows) longest_ms = std::max(longest_ms, time_ms(row));
  const double width_ms = std::max(longest_ms, 1e-3) / kHistogramBars;
  std::vector<ChartBar> bars;
  for (std::size_t i = 0; i < kHistogramBars; ++i)
    bars.push_back({width_ms * static_cast<double>(i), width_ms * static_cast<double>(i + 1), {0}});
  for (const FrameRow& row : rows)
    ++bars[std::min(kHistogramBars - 1, static_cast<std::size_t>(time_ms(row) / width_ms))].parts[0];
  return chartFigure(
      barChart({.x = paced ? "latency, ms" : "processing, ms", .y = "frames"}, {{"", "var(--line1)"}}, bars),
      paced ? "From the moment a pair was due until its result could be read."
            : "Work of the stages on each pair, without waiting. The pairs followed each other as fast as they could "
              "(no --rate), so that their latency, in the table below, is mostly queueing.");
}

/// Parts of the timeline. All waits are one part. Stereo matching and optical flow are two, of which only the longer is
/// on a frame's path.
struct Timeline {
  std::vector<ChartPart> parts;
  std::size_t partOf(const std::string& name) const {
    for (std::size_t part = 0; part < parts.size(); ++part)
      if (parts[part].name == name) return part;
    return 0;
  }
};

Timeline timelineParts() {
  Timeline timeline{{{"waiting", "var(--wait)"}}};
  for (std::size_t stage = 0; stage < kStageCount; ++stage)
    timeline.parts.push_back({nameOf(static_cast<Stage>(stage)), fmt::format("var(--s{})", stage + 1)});
  return timeline;
}

/// A bar per frame; for long runs, the slowest frame of each group.
std::string stageTimeline(const std::vector<FrameRow>& rows) {
  const Timeline timeline = timelineParts();
  const std::size_t group = std::max<std::size_t>(1, (rows.size() + kTimelineBars - 1) / kTimelineBars);
  std::vector<ChartBar> bars;
  for (std::size_t begin = 0; begin < rows.size(); begin += group) {
    const std::size_t end = std::min(rows.size(), begin + group);
    const auto slowest =
        std::ranges::max_element(rows.begin() + static_cast<std::ptrdiff_t>(begin),
                                 rows.begin() + static_cast<std::ptrdiff_t>(end), {}, &FrameRow::latency_ms);
    ChartBar bar{static_cast<double>(rows[begin].head.frame.value),
                 static_cast<double>(rows[end - 1].head.frame.value + 1), std::vector<double>(timeline.parts.size())};
    for (const WayPart& part : longestWay(*slowest)) bar.parts[timeline.partOf(part.name)] += part.ms;
    bars.push_back(std::move(bar));
  }
  return chartFigure(barChart({.x = "frame", .y = "ms"}, timeline.parts, bars),
                     group == 1 ? "Each frame's way through the pipeline."
                                : fmt::format("The slowest of each {} frames on its way through the pipeline.", group));
}

}  // namespace

std::string runSection(const ReportedRun& reported) {
  const Json summary = summaryOf(reported.run);
  const std::filesystem::path sequence = summary.value("sequence", "");
  const std::string name = reported.drive.name;
  std::string text = "<h1>" + escaped(sequence.has_filename() ? sequence.filename().string() : name) +
                     "</h1>\n<p class=\"muted\">" + escaped(sequence.empty() ? "" : sequence.string() + " · ") +
                     "results in " + escaped(name) + " &middot; " + escaped(framesText(reported)) + "</p>\n";
  if (!reported.run.complete())
    text +=
        "<div class=\"finding warn\"><p>The run did not come to its end: the estimates of its last frames are as "
        "they were published, and the rest as it was settled by then.</p></div>\n";
  if (!reported.missing.empty())
    text += std::string("<div class=\"finding warn\"><p>") +
            (reported.sequence ? "Without measures: " : "Without pictures and truth: ") + escaped(reported.missing) +
            "</p></div>\n";
  return text + cards(reported, summary);
}

std::string settingsSection(const ReportedRun& reported) {
  const Json summary = summaryOf(reported.run);
  std::string text = "<h2>Settings and versions</h2>\n";
  if (const std::string rows = versionRows(summary); !rows.empty())
    text += "<div class=\"wide\"><table><tbody>\n" + rows + "</tbody></table></div>\n";
  if (const auto file = reported.run.folder / "effective_config.toml"; std::filesystem::exists(file))
    text += "<details><summary>Every parameter in force (effective_config.toml)</summary><pre>" +
            escaped(readWhole(file)) + "</pre></details>\n";
  return text;
}

std::string accuracySection(const ReportedRun& reported) {
  if (!reported.evaluation) return "";
  return "<h2>Accuracy</h2>\n" + errorChart(reported) +
         "<details open><summary>All measures, as motorcade evaluate prints them</summary><pre>" +
         escaped(tableOf(*reported.evaluation)) + "</pre></details>\n";
}

std::string latencySection(const ReportedRun& reported) {
  const auto rows = enteredRows(reported.run);
  if (rows.empty()) return "";
  std::string text = "<h2>Latency</h2>\n<div class=\"grid\">\n" + histogram(rows, wasPaced(reported.run));
  if (rows.front().has_waits) text += stageTimeline(rows);
  return text + "</div>\n<details><summary>Stage by stage, as motorcade latency prints it</summary><pre>" +
         escaped(latencyTable(latencyReport(reported.run.frames))) + "</pre></details>\n";
}

}  // namespace motorcade
