#include "apps/latency/latency_report.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <span>
#include <utility>

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
    stages.push_back({std::string(kStageNames[stage]),
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
    way.push_back({"waiting for " + std::string(nameOf(stage)), time(stage).wait_ms});
    way.push_back({std::string(nameOf(stage)), time(stage).work_ms});
  };
  const auto ends_ms = [&](Stage stage) { return time(stage).wait_ms + time(stage).work_ms; };
  follow(Stage::kPrepare);
  follow(ends_ms(Stage::kStereoMatching) > ends_ms(Stage::kOpticalFlow) ? Stage::kStereoMatching : Stage::kOpticalFlow);
  for (const Stage stage :
       {Stage::kSceneFlowSegmentation, Stage::kTracking, Stage::kIncrementalOptimization, Stage::kObjectShapes})
    follow(stage);
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

}  // namespace motorcade
