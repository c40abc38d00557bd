#include "apps/latency/latency_table.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/files/json_text.hpp"

namespace motorcade {
namespace {

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

}  // namespace

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

}  // namespace motorcade
