#include <filesystem>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/html/html_page.hpp"
#include "apps/latency/latency_report.hpp"
#include "apps/recorded/recorded_run.hpp"
#include "apps/report/report_sections.hpp"
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

}  // namespace motorcade
