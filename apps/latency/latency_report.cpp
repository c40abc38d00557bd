#include "apps/latency/latency_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <numeric>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/files/errors.hpp"
#include "io/files/json_text.hpp"
#include "io/files/line_file.hpp"

namespace motorcade {
namespace {

/// Least time above the median that is worth reporting.
constexpr double kTold_ms = 0.1;

template <class Value>
Percentiles percentilesOver(const std::vector<FrameRow>& rows, const Value& value) {
  std::vector<double> values;
  values.reserve(rows.size());
  for (const FrameRow& row : rows) values.push_back(value(row));
  return percentilesOf(std::move(values));
}

std::vector<StageLatency> stagesOf(const std::vector<FrameRow>& rows) {
  std::vector<StageLatency> stages;
  for (std::size_t stage = 0; stage < kStageCount; ++stage)
    stages.push_back({nameOf(static_cast<Stage>(stage)),
                      percentilesOver(rows, [stage](const FrameRow& row) { return row.stages[stage].work_ms; }),
                      percentilesOver(rows, [stage](const FrameRow& row) { return row.stages[stage].wait_ms; }),
                      percentilesOver(rows, [stage](const FrameRow& row) { return row.stages[stage].cpu_ms; })});
  return stages;
}

/// The two branches differ from frame to frame, so that each part has a median of its own, over the frames that took
/// it.
std::map<std::string, double> medianWay(const std::vector<FrameRow>& rows) {
  std::map<std::string, std::vector<double>> parts;
  for (const FrameRow& row : rows)
    for (const WayPart& part : longestWay(row)) parts[part.name].push_back(part.ms);
  std::map<std::string, double> medians;
  for (auto& [name, values] : parts) medians[name] = percentilesOf(std::move(values)).p50;
  return medians;
}

std::vector<WayPart> aboveMedian(const FrameRow& row, const std::map<std::string, double>& medians) {
  std::vector<WayPart> parts = longestWay(row);
  for (WayPart& part : parts) part.ms -= medians.at(part.name);
  std::erase_if(parts, [](const WayPart& part) { return part.ms < kTold_ms; });
  std::ranges::sort(parts, std::greater(), &WayPart::ms);
  return parts;
}

using Json = nlohmann::ordered_json;

constexpr std::size_t kToldParts = 3;

std::string timesOf(const Percentiles& of) {
  return fmt::format("{:8.2f} {:8.2f} {:8.2f} {:8.2f}", of.p50, of.p95, of.p99, of.max);
}

std::string row(std::string_view name, const Percentiles& times) {
  return fmt::format("{:<26}{}\n", name, timesOf(times));
}

std::string stageRow(const StageLatency& stage, bool has_waits) {
  std::string text = fmt::format("  {:<24}{}", stage.name, timesOf(stage.work_ms));
  if (has_waits)
    text += fmt::format("  {:8.2f} {:8.2f}  {:8.2f} {:8.2f}", stage.wait_ms.p50, stage.wait_ms.p99, stage.cpu_ms.p50,
                        stage.cpu_ms.p99);
  return text + "\n";
}

std::string slowRow(const SlowFrame& slow) {
  std::string text = fmt::format("{:>8} {:>10.2f}   ", slow.row.head.frame.value, slow.row.latency_ms);
  for (std::size_t part = 0; part < std::min(kToldParts, slow.above_median.size()); ++part)
    text += fmt::format("{}{:.2f} {}", part > 0 ? ", " : "", slow.above_median[part].ms, slow.above_median[part].name);
  return text + (slow.above_median.empty() ? "nothing in particular\n" : "\n");
}

Json toJson(const Percentiles& of) { return {{"p50", of.p50}, {"p95", of.p95}, {"p99", of.p99}, {"max", of.max}}; }

std::string latencyJson(const LatencyReport& report) {
  Json stages, slowest = Json::array();
  for (const StageLatency& stage : report.stages)
    stages[stage.name] = {
        {"work_ms", toJson(stage.work_ms)}, {"wait_ms", toJson(stage.wait_ms)}, {"cpu_ms", toJson(stage.cpu_ms)}};
  for (const SlowFrame& slow : report.slowest) {
    Json parts = Json::array();
    for (const WayPart& part : slow.above_median) parts.push_back({{"part", part.name}, {"above_median_ms", part.ms}});
    slowest.push_back({{"frame", slow.row.head.frame.value}, {"latency_ms", slow.row.latency_ms}, {"lost_in", parts}});
  }
  const Json json{{"frames", report.frames},
                  {"dropped", report.dropped},
                  {"rejected", report.rejected},
                  {"lost", report.lost},
                  {"latency_ms", toJson(report.latency_ms)},
                  {"decode_ms", toJson(report.decode_ms)},
                  {"entry_wait_ms", toJson(report.entry_wait_ms)},
                  {"publish_wait_ms", toJson(report.publish_wait_ms)},
                  {"stages", stages},
                  {"slowest", slowest}};
  return jsonText(json, 2) + "\n";
}

}  // namespace

Percentiles percentilesOf(std::vector<double> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  const auto rank = [&values](double fraction) {
    const auto count = std::ceil(fraction * static_cast<double>(values.size()));
    return values[static_cast<std::size_t>(std::max(1.0, count)) - 1];
  };
  return {rank(0.50), rank(0.95), rank(0.99), values.back()};
}

std::vector<WayPart> longestWay(const FrameRow& row) {
  std::vector<WayPart> way{{"waiting to enter", row.entry_wait_ms}};
  const auto time = [&row](Stage stage) -> const FrameRow::StageTime& {
    return row.stages[static_cast<std::size_t>(stage)];
  };
  const auto follow = [&](Stage stage) {
    way.push_back({"waiting for " + nameOf(stage), time(stage).wait_ms});
    way.push_back({nameOf(stage), time(stage).work_ms});
  };
  const auto ends_ms = [&](Stage stage) { return time(stage).wait_ms + time(stage).work_ms; };
  const bool stereo_is_last = ends_ms(Stage::kStereoMatching) > ends_ms(Stage::kOpticalFlow);
  for (const Stage stage : pathOver(stereo_is_last ? Stage::kStereoMatching : Stage::kOpticalFlow)) follow(stage);
  way.push_back({"publishing", row.publish_wait_ms});
  return way;
}

double processing_ms(const std::array<double, kStageCount>& work_ms) {
  const auto of = [&work_ms](Stage stage) { return work_ms[static_cast<std::size_t>(stage)]; };
  return std::accumulate(work_ms.begin(), work_ms.end(), 0.0) -
         std::min(of(Stage::kStereoMatching), of(Stage::kOpticalFlow));
}

double processing_ms(const FrameRow& row) {
  std::array<double, kStageCount> work_ms{};
  for (std::size_t stage = 0; stage < kStageCount; ++stage) work_ms[stage] = row.stages[stage].work_ms;
  return processing_ms(work_ms);
}

LatencyReport latencyReport(const std::vector<FrameRow>& rows, std::size_t slowest) {
  LatencyReport report;
  std::vector<FrameRow> entered;
  for (const FrameRow& row : rows) {
    report.dropped += row.head.status == FrameStatus::kDropped;
    report.rejected += row.head.status == FrameStatus::kRejected;
    report.lost += row.head.status == FrameStatus::kLost;
    if (row.head.status != FrameStatus::kDropped) entered.push_back(row);
  }
  report.frames = entered.size();
  report.has_waits = std::ranges::any_of(entered, &FrameRow::has_waits);
  report.latency_ms = percentilesOver(entered, [](const FrameRow& row) { return row.latency_ms; });
  report.decode_ms = percentilesOver(entered, [](const FrameRow& row) { return row.decode_ms; });
  report.entry_wait_ms = percentilesOver(entered, [](const FrameRow& row) { return row.entry_wait_ms; });
  report.publish_wait_ms = percentilesOver(entered, [](const FrameRow& row) { return row.publish_wait_ms; });
  report.stages = stagesOf(entered);
  const auto medians = medianWay(entered);
  const auto count = static_cast<std::ptrdiff_t>(std::min(slowest, entered.size()));
  std::ranges::partial_sort(entered, entered.begin() + count, std::greater(), &FrameRow::latency_ms);
  for (const FrameRow& row : std::span(entered).first(static_cast<std::size_t>(count)))
    report.slowest.push_back({row, aboveMedian(row, medians)});
  return report;
}

std::string latencyTable(const LatencyReport& report) {
  std::string text = fmt::format("frames    {} entered, of them {} lost, {} rejected; {} were dropped before\n\n",
                                 report.frames, report.lost, report.rejected, report.dropped);
  text += fmt::format("{:<26}{:>8} {:>8} {:>8} {:>8}", "ms", "p50", "p95", "p99", "max");
  if (report.has_waits) text += fmt::format("  {:>17}  {:>17}", "wait  p50     p99", "CPU  p50     p99");
  text += fmt::format("\n{}", row("latency", report.latency_ms));
  if (report.has_waits) text += row("  waiting to enter", report.entry_wait_ms);
  for (const StageLatency& stage : report.stages) text += stageRow(stage, report.has_waits);
  if (report.has_waits) text += row("  publishing", report.publish_wait_ms);
  text += row("decoding ahead", report.decode_ms);
  text +=
      "\nlatency: from the moment a pair was due until its result could be read; decoding ahead is not in it\n"
      "wait: from when a stage had all it needs until it began; CPU: of its own thread, without helpers\n";
  if (!report.has_waits) return text + "waits and CPU are missing: the run is of an earlier version\n";
  text += fmt::format("\nslowest frames\n{:>8} {:>10}   {}\n", "frame", "latency ms",
                      "ms above the median of the same part of the way");
  for (const SlowFrame& slow : report.slowest) text += slowRow(slow);
  return text;
}

int runLatency(const LatencyOptions& options) {
  const auto file = options.run / "frames.csv";
  const auto rows = readFrames(file);
  if (rows.empty()) throw InputError(file.string() + ": no frames; name the folder of a run");
  const LatencyReport report = latencyReport(rows);
  std::fputs(latencyTable(report).c_str(), stdout);
  if (!options.json.empty()) writeAtOnce(options.json, latencyJson(report));
  return 0;
}

}  // namespace motorcade
