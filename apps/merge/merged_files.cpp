#include "apps/merge/merged_files.hpp"

#include <cmath>
#include <iostream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/merge/published_tables.hpp"
#include "apps/tasks/batch_folder.hpp"
#include "apps/tasks/task_json.hpp"
#include "io/files/errors.hpp"
#include "io/files/file_descriptor.hpp"
#include "io/files/line_file.hpp"

namespace motorcade {
namespace {

Json valueOf(double value) { return std::isnan(value) ? Json() : Json(value); }

Json valuesOf(const MeasureValues& values) {
  Json json = Json::object();
  for (std::size_t i = 0; i < values.size(); ++i) json[std::string(allMeasures()[i].name)] = valueOf(values[i]);
  return json;
}

std::string failureOf(const MergedTask& task) {
  return task.record.failure ? task.record.failure->message : std::string();
}

Json jsonOf(const MergedTask& task) {
  Json json = {{"task", task.task.name},
               {"drive", task.task.drive},
               {"set", task.task.set},
               {"seed", orNull(task.task.seed)},
               {"repetition", task.task.repetition},
               {"status", std::string(outcomeName(task.outcome))},
               {"failure", failureOf(task)},
               {"last_lines", task.record.failure ? task.record.failure->last_lines : std::vector<std::string>()}};
  json["measures"] = task.outcome == TaskOutcome::kDone ? valuesOf(task.values) : Json();
  return json;
}

Json jsonOf(const WorstFrame& frame) {
  if (frame.task.empty()) return nullptr;
  return {{"task", frame.task}, {"frame", frame.frame}, {"value", frame.value}, {"more", frame.more}};
}

Json jsonOf(const ResultGroup& group) {
  Json measures = Json::object();
  for (const Measure& measure : allMeasures())
    if (const auto n = group.count(measure.name); n > 0)
      measures[std::string(measure.name)] = {{"mean", group.mean(measure.name)},
                                             {"min", group.smallest(measure.name)},
                                             {"max", group.largest(measure.name)},
                                             {"seeds", n}};
  return {{"drive", group.drive()},
          {"set", group.set()},
          {"measures", std::move(measures)},
          {"worst_frames",
           {{"camera_rpe_t_m", jsonOf(group.worst().camera_m)},
            {"object_me_t_m", jsonOf(group.worst().object_m)},
            {"latency_ms", jsonOf(group.worst().latest_ms)}}}};
}

Json jsonOf(const std::vector<WorstFrame>& frames) {
  Json json = Json::array();
  for (const WorstFrame& frame : frames) json.push_back(jsonOf(frame));
  return json;
}

Json jsonOf(const BatchComparison& comparison) {
  Json measures = Json::array(), regressions = Json::array();
  for (const auto& m : comparison.measures)
    measures.push_back({{"measure", std::string(m.measure)},
                        {"pairs", m.pairs},
                        {"better", m.better},
                        {"worse", m.worse},
                        {"median_change", m.median_change},
                        {"p", m.p},
                        {"corrected_p", m.corrected_p},
                        {"verdict", m.verdict}});
  for (const auto& r : comparison.regressions)
    regressions.push_back({{"result", r.result},
                           {"measure", std::string(r.measure)},
                           {"before", r.before},
                           {"now", r.now},
                           {"change", r.change}});
  return {{"against", comparison.against.string()},
          {"measures", std::move(measures)},
          {"regressions", std::move(regressions)},
          {"unpaired", comparison.unpaired}};
}

/// Quotes a field of a CSV table by RFC 4180.
std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + '"';
}

void addValues(std::vector<std::string>& row, const MeasureValues& values) {
  for (const double value : values) row.push_back(std::isnan(value) ? "" : fmt::format("{}", value));
}

Json jsonOf(const PublishedFigure& figure) {
  return {{"method", figure.method}, {"measure", figure.measure}, {"drives", figure.drives},
          {"value", figure.value},   {"source", figure.source},   {"note", figure.note}};
}

std::string joined(const std::vector<std::string>& fields) { return fmt::format("{}\n", fmt::join(fields, ",")); }

namespace fs = std::filesystem;

Merged mergedOf(const MergeOptions& options) {
  Merged merged{.batch = readBatch(absoluteFolder(options.batch), options.baseline_set)};
  if (merged.batch.count(TaskOutcome::kDone) == 0)
    throw InputError(options.batch.string() +
                     ": no task of this plan is done yet, or all were planned anew since; see motorcade batch status");
  merged.groups = groupsOf(merged.batch);
  if (!options.against.empty()) {
    const MergedBatch other = readBatch(absoluteFolder(options.against), "");
    if (other.count(TaskOutcome::kDone) == 0)
      throw InputError(options.against.string() + ": no task is done there, so there is nothing to compare with");
    merged.comparison = compareBatches(merged.groups, groupsOf(other), options.against);
  }
  return merged;
}

/// A row for each task, with every measure.
std::string csvOf(const Merged& merged) {
  std::vector<std::string> head{"task", "drive", "set", "seed", "repetition", "status", "failure"};
  for (const Measure& measure : allMeasures()) head.emplace_back(measure.name);
  std::string csv = joined(head);
  for (const MergedTask& task : merged.batch.tasks) {
    std::vector<std::string> row{task.task.name,
                                 task.task.drive,
                                 task.task.set,
                                 task.task.seed ? std::to_string(*task.task.seed) : "",
                                 std::to_string(task.task.repetition),
                                 std::string(outcomeName(task.outcome)),
                                 csvField(failureOf(task))};
    addValues(row, task.values);
    csv += joined(row);
  }
  for (const PublishedRow& published : publishedRows(merged.batch.plan.published)) {
    std::vector<std::string> row{csvField("published." + published.method),
                                 csvField(published.drive),
                                 csvField(published.method),
                                 "",
                                 "",
                                 "published",
                                 csvField(published.source)};
    addValues(row, published.values);
    csv += joined(row);
  }
  return csv;
}

/// Tasks without a result, and the reasons.
ResultTable unfinishedTable(const MergedBatch& batch) {
  ResultTable table{.title = "Without result", .heads = {"task", "status", "why", "last line"}, .names = 4};
  for (const MergedTask& task : batch.tasks) {
    if (task.outcome == TaskOutcome::kDone) continue;
    const bool has_lines = task.record.failure && !task.record.failure->last_lines.empty();
    table.rows.push_back({task.task.name, std::string(outcomeName(task.outcome)), failureOf(task),
                          has_lines ? task.record.failure->last_lines.back() : ""});
  }
  return table;
}

}  // namespace

std::string jsonOf(const Merged& merged) {
  const MergedBatch& batch = merged.batch;
  Json tasks = Json::array(), groups = Json::array(), left_out = Json::array(), published = Json::array();
  for (const LeftOutDrive& drive : batch.plan.left_out)
    left_out.push_back({{"drive", drive.name}, {"looked_for", drive.looked_for}});
  for (const PublishedFigure& figure : batch.plan.published) published.push_back(jsonOf(figure));
  for (const MergedTask& task : batch.tasks) tasks.push_back(jsonOf(task));
  for (const ResultGroup& group : merged.groups) groups.push_back(jsonOf(group));
  return textOf({{"tasks", std::move(tasks)},
                 {"groups", std::move(groups)},
                 {"worst_frames",
                  {{"camera_rpe_t_m", jsonOf(batch.worst_camera_m)},
                   {"object_me_t_m", jsonOf(batch.worst_object_m)},
                   {"latency_ms", jsonOf(batch.latest_ms)}}},
                 {"existence", reliabilityJson(kExistenceClaim, batch.existence)},
                 {"kinds", reliabilityJson(kKindClaim, batch.kinds)},
                 {"covariances", covarianceJson(batch.covariances)},
                 {"left_out", std::move(left_out)},
                 {"published", std::move(published)},
                 {"comparison", merged.comparison ? jsonOf(*merged.comparison) : Json()}});
}

std::string markdownOf(const Merged& merged) {
  const MergedBatch& batch = merged.batch;
  std::string text =
      fmt::format("# {} tasks: {} done, {} failed, {} missing\n\n", batch.tasks.size(), batch.count(TaskOutcome::kDone),
                  batch.count(TaskOutcome::kFailed), batch.count(TaskOutcome::kMissing));
  const auto add = [&](const ResultTable& table) {
    if (!table.rows.empty()) text += markdownOf(table);
  };
  add(overviewTable(merged.groups));
  for (const ResultTable& table : publishedSection(merged)) add(table);
  if (merged.comparison) {
    add(testTable(*merged.comparison));
    add(regressionTable(*merged.comparison));
    if (!merged.comparison->unpaired.empty())
      text += fmt::format("Not compared: {}.\n\n", fmt::join(merged.comparison->unpaired, ", "));
  }
  add(unfinishedTable(batch));
  add(leftOutTable(batch));
  for (const ResultTable& table : measureTables(merged.groups)) add(table);
  add(reliabilityTable(kExistenceClaim, batch.existence));
  add(reliabilityTable(kKindClaim, batch.kinds));
  add(covarianceTable(batch.covariances));
  add(worstFrameTable("Frames with the largest error of the camera's motion", "RPE_t m", batch.worst_camera_m));
  add(worstFrameTable("Frames with the largest error of an object's motion", "ME_t m", batch.worst_object_m));
  add(worstFrameTable("Frames that came out latest", "latency ms", batch.latest_ms));
  return text;
}

std::vector<ResultTable> publishedSection(const Merged& merged) {
  const auto& figures = merged.batch.plan.published;
  std::vector<ResultTable> tables = publishedTables(merged.groups, figures);
  tables.push_back(publishedMeans(merged.groups, figures));
  tables.push_back(publishedSources(merged.groups, figures));
  tables.push_back(otherFrames(merged.groups, figures));
  std::erase_if(tables, [](const ResultTable& table) { return table.rows.empty(); });
  return tables;
}

ResultTable leftOutTable(const MergedBatch& batch) {
  ResultTable table{.title = "Left out, as not on the disk", .heads = {"drive", "looked for"}, .names = 2};
  for (const LeftOutDrive& drive : batch.plan.left_out) table.rows.push_back({drive.name, drive.looked_for});
  return table;
}

ResultTable worstFrameTable(const std::string& title, const std::string& value, const std::vector<WorstFrame>& frames) {
  ResultTable table{.title = title, .heads = {"task", "what", "to see it", "frame", value}, .names = 3};
  for (const WorstFrame& frame : frames)
    table.rows.push_back({frame.task, frame.more,
                          fmt::format("motorcade draw results/{}/run --frames {}:{} --out frames", frame.task,
                                      std::max<std::int64_t>(0, frame.frame - 1), frame.frame + 1),
                          std::to_string(frame.frame), fmt::format("{:.4g}", frame.value)});
  return table;
}

int runMerge(const MergeOptions& options) {
  const Merged merged = mergedOf(options);
  const fs::path out = options.out.empty() ? BatchFolder(options.batch).merged() : options.out;
  makeFolder(out);
  writeAtOnce(out / "results.csv", csvOf(merged));
  writeAtOnce(out / "results.json", jsonOf(merged));
  writeAtOnce(out / "results.md", markdownOf(merged));
  writeAtOnce(out / "report.html", pageOf(merged));
  std::cout << markdownOf(overviewTable(merged.groups));
  const ResultTable means = publishedMeans(merged.groups, merged.batch.plan.published);
  if (!means.rows.empty()) std::cout << markdownOf(means);
  if (merged.comparison) std::cout << markdownOf(testTable(*merged.comparison));
  std::cout << "tables and page: " << out.string() << "/results.md, .csv, .json, report.html\n";
  return 0;
}

}  // namespace motorcade
