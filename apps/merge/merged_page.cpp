#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "apps/html/html_page.hpp"
#include "apps/html/svg_chart.hpp"
#include "apps/merge/merged_files.hpp"

namespace motorcade {
namespace {

/// Better and worse differ by a sign, too, for readers who see no red or no green.
constexpr std::string_view kStyle = R"css(
.wide th, .wide td { white-space: nowrap; }
.grid { display: grid; gap: 1rem; align-items: start;
  grid-template-columns: repeat(auto-fill, minmax(min(100%, 26rem), 1fr)); }
.grid figure { margin: 0; }
td.better { color: var(--good); font-weight: 600; } td.worse { color: var(--bad); font-weight: 600; }
td.better::before { content: "\2713\00A0"; }
td.worse::before { content: "\2717\00A0"; }
)css";

constexpr std::size_t kMostRows = 40;  // of a chart: more drives than that are told by the tables

std::string section(const std::string& title, const std::string& content) {
  return content.empty() ? "" : fmt::format("<h2>{}</h2>\n{}", escaped(title), content);
}

std::string section(const ResultTable& table) { return table.rows.empty() ? "" : section(table.title, htmlOf(table)); }

std::string card(const std::string& value, const std::string& label) {
  return fmt::format(R"(<div class="card"><div class="value">{}</div><div class="label">{}</div></div>)",
                     escaped(value), escaped(label));
}

std::string cards(const MergedBatch& batch) {
  const std::size_t cpu = measureIndex("cpu_s"), frames = measureIndex("frames");
  double cpu_s = 0, frame_count = 0;
  for (const MergedTask& task : batch.tasks) {
    if (!std::isnan(task.values[cpu])) cpu_s += task.values[cpu];
    if (!std::isnan(task.values[frames])) frame_count += task.values[frames];
  }
  constexpr double kMinute_s = 60, kHour_s = 3600;
  const std::size_t unfinished = batch.tasks.size() - batch.count(TaskOutcome::kDone);
  return "<div class=\"cards\">" + card(std::to_string(batch.count(TaskOutcome::kDone)), "tasks done") +
         card(std::to_string(unfinished), "without result") +
         card(fmt::format("{:.0f}", frame_count), "frames measured") +
         card(cpu_s < kHour_s ? fmt::format("{:.1f} min", cpu_s / kMinute_s) : fmt::format("{:.1f} h", cpu_s / kHour_s),
              "CPU of all runs") +
         "</div>\n";
}

std::vector<std::string> setNames(const std::vector<ResultGroup>& groups) {
  std::vector<std::string> names;
  for (const ResultGroup& group : groups)
    if (std::ranges::find(names, group.set()) == names.end()) names.push_back(group.set());
  return names;
}

/// A color for each set of parameters; a single set has no name.
std::vector<ChartPart> seriesOf(const std::vector<std::string>& sets) {
  constexpr std::array kColors{1, 7, 3, 5, 4, 6, 2};  // those first that differ most
  std::vector<ChartPart> series;
  for (std::size_t i = 0; i < sets.size(); ++i)
    series.push_back({sets.size() > 1 ? sets[i] : "", fmt::format("var(--s{})", kColors[i % kColors.size()])});
  return series;
}

/// One measure by drive and set, each seed a dot. Of many drives those with the largest values.
std::string distribution(const std::vector<ResultGroup>& groups, std::string_view measure, const std::string& label) {
  const auto sets = setNames(groups);
  const std::size_t index = measureIndex(measure);
  std::vector<DotRow> rows;
  for (const ResultGroup& group : groups) {
    if (group.count(measure) == 0) continue;
    if (rows.empty() || rows.back().name != group.drive()) rows.push_back({group.drive(), {}});
    rows.back().values.resize(sets.size());
    auto& values = rows.back().values[static_cast<std::size_t>(std::ranges::find(sets, group.set()) - sets.begin())];
    for (const auto& seed : group.seeds()) values.push_back(seed.values[index]);
  }
  if (rows.empty()) return "";
  std::string caption = label + ", by drive; each dot is a seed";
  if (rows.size() > kMostRows) {
    const auto largest = [](const DotRow& row) {
      double value = 0;
      for (const auto& values : row.values)
        for (const double each : values) value = std::max(value, std::isnan(each) ? 0 : each);
      return value;
    };
    std::ranges::stable_sort(rows, std::greater(), largest);
    caption += fmt::format("; the {} largest of {} drives", kMostRows, rows.size());
    rows.resize(kMostRows);
  }
  return chartFigure(dotChart(label, seriesOf(sets), rows), caption);
}

std::string distributions(const std::vector<ResultGroup>& groups) {
  const std::string charts = distribution(groups, "camera_ate_m", "camera ATE, m") +
                             distribution(groups, "camera_rpe_t_rmse_m", "camera RPE, m per frame") +
                             distribution(groups, "me_t_m", "motion error of objects, m per frame") +
                             distribution(groups, "objects_as_seen_m", "objects as seen, m") +
                             distribution(groups, "latency_p50_ms", "median latency, ms") +
                             distribution(groups, "latency_p99_ms", "99th percentile of latency, ms");
  return charts.empty() ? "" : "<div class=\"grid\">\n" + charts + "</div>\n";
}

/// Chart of the share of all frames whose latency is below a number of milliseconds.
std::string latencyDistribution(const MergedBatch& batch) {
  std::vector<ChartLine> lines;
  std::vector<std::string> sets;
  for (const auto& [set, latencies] : batch.latencies)
    if (!latencies.empty()) sets.push_back(set);
  const auto series = seriesOf(sets);
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const auto& latencies = batch.latencies.at(sets[i]);
    double all = 0, so_far = 0;
    for (const auto& [ms, frames] : latencies) all += static_cast<double>(frames);
    ChartLine line{.name = series[i].name, .color = series[i].color, .points = {{0, 0}}};
    for (const auto& [ms, frames] : latencies) {
      so_far += static_cast<double>(frames);
      line.points.emplace_back(ms, 100 * so_far / all);
    }
    lines.push_back(std::move(line));
  }
  if (lines.empty()) return "";
  return chartFigure(lineChart({.x = "latency, ms", .y = "% of frames", .wide = true}, lines),
                     "Frames of all drives that came out within a time, from the moment the pair was due.");
}

std::string comparisonSection(const BatchComparison& comparison) {
  std::string html = section(testTable(comparison));
  html +=
      "<p class=\"muted\">Pairs of the same drive, set and seed; repetitions are averaged first. Changes are relative "
      "to the mean of both. p is that of Wilcoxon's signed-rank test, corrected by Holm for the number of "
      "measures. \u2713 marks what is surely better, \u2717 what is worse.</p>\n";
  const ResultTable regressions = regressionTable(comparison);
  html += regressions.rows.empty() ? "<p class=\"finding good\">No accuracy became worse by more than 2 %.</p>\n"
                                   : section(regressions);
  if (!comparison.unpaired.empty())
    html += "<p>Not compared: " + escaped(fmt::format("{}", fmt::join(comparison.unpaired, ", "))) + "</p>\n";
  return html;
}

std::string failureSection(const MergedBatch& batch) {
  std::string html;
  for (const MergedTask& task : batch.tasks) {
    if (task.outcome == TaskOutcome::kDone) continue;
    const bool failed = task.record.failure.has_value();
    html += fmt::format("<div class=\"finding bad\"><b>{}</b>: {}", escaped(task.task.name),
                        escaped(failed ? task.record.failure->message : "not done yet"));
    if (failed && !task.record.failure->last_lines.empty())
      html += "<pre>" + escaped(fmt::format("{}", fmt::join(task.record.failure->last_lines, "\n"))) + "</pre>";
    html += "</div>\n";
  }
  return section("Without result", html);
}

}  // namespace

std::string pageOf(const Merged& merged) {
  const MergedBatch& batch = merged.batch;
  std::string body = "<h1>" + escaped(batch.folder.filename().string()) + "</h1>\n" + cards(batch);
  if (merged.comparison) body += comparisonSection(*merged.comparison);
  body += failureSection(batch) + section(overviewTable(merged.groups));
  for (const ResultTable& table : publishedSection(merged)) body += section(table);
  body += section(leftOutTable(batch));
  if (setNames(merged.groups).size() > 1)
    body +=
        "<p class=\"muted\">Of the sets of a drive \u2713 marks the best by a measure, \u2717 the worst, where they "
        "differ by more than 2 %.</p>\n";
  body += section("Distributions", distributions(merged.groups) + latencyDistribution(batch));
  body += section(worstFrameTable("Frames with the largest error of the camera's motion", "motion error [m]",
                                  batch.worst_camera_m));
  body += section(
      worstFrameTable("Frames with the largest error of an object's motion", "motion error [m]", batch.worst_object_m));
  body += section(worstFrameTable("Frames that came out latest", "latency [ms]", batch.latest_ms));
  for (const ResultTable& table : measureTables(merged.groups)) body += section(table);
  body += section(reliabilityTable(kExistenceClaim, batch.existence));
  body += section(reliabilityTable(kKindClaim, batch.kinds));
  body += section(covarianceTable(batch.covariances)) + covarianceCharts(batch.covariances);
  return htmlPage("Batch " + batch.folder.filename().string(), body, std::string(kChartStyle).append(kStyle));
}

}  // namespace motorcade
