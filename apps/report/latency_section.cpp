#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "apps/html/html_page.hpp"
#include "apps/html/svg_chart.hpp"
#include "apps/latency/latency_table.hpp"
#include "apps/recorded/recorded_run.hpp"
#include "apps/report/report_sections.hpp"

namespace motorcade {
namespace {

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
    timeline.parts.push_back({std::string(kStageNames[stage]), fmt::format("var(--s{})", stage + 1)});
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

std::string latencySection(const ReportedRun& reported) {
  const auto rows = enteredRows(reported.run);
  if (rows.empty()) return "";
  std::string text = "<h2>Latency</h2>\n<div class=\"grid\">\n" + histogram(rows, wasPaced(reported.run));
  if (rows.front().has_waits) text += stageTimeline(rows);
  return text + "</div>\n<details><summary>Stage by stage, as motorcade latency prints it</summary><pre>" +
         escaped(latencyTable(latencyReport(reported.run.frames))) + "</pre></details>\n";
}

}  // namespace motorcade
