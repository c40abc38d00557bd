#include "apps/merge/merged_batch.hpp"

#include <algorithm>
#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/console/log.hpp"
#include "apps/evaluate/measures/evaluation.hpp"
#include "apps/latency/latency_report.hpp"
#include "apps/merge/published_tables.hpp"
#include "apps/tasks/batch_folder.hpp"
#include "apps/tasks/task_performer.hpp"
#include "io/files/errors.hpp"
#include "io/files/file_names.hpp"
#include "io/files/json_text.hpp"
#include "io/files/text_file.hpp"
#include "io/results/frame_table.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostWorst = 20;
constexpr std::ptrdiff_t kMostOfATask = 3;  // so that one bad drive does not fill the list

nlohmann::json jsonIn(const fs::path& file) {
  std::error_code none;
  if (!fs::exists(file, none)) return nullptr;
  try {
    return parsedJson(readWhole(file));
  } catch (const nlohmann::json::exception& error) {
    throw InputError(file.string() + ": is damaged (" + printable(error.what(), 100) +
                     "); remove the folder of this result and run the batch again");
  }
}

/// Keeps the largest values; the first one when two are equal.
void keepWorst(std::vector<WorstFrame>& worst, WorstFrame frame) {
  const auto place = std::ranges::upper_bound(worst, frame.value, std::greater(), &WorstFrame::value);
  if (place == worst.end() && worst.size() == kMostWorst) return;
  worst.insert(place, std::move(frame));
  if (worst.size() > kMostWorst) worst.pop_back();
}

/// A frame of a task, which its batch may keep, too.
void addWorst(std::vector<WorstFrame>& of_batch, WorstFrame& of_task, const WorstFrame& frame) {
  if (of_task.task.empty() || frame.value > of_task.value) of_task = frame;
  keepWorst(of_batch, frame);
}

void addWorstErrors(MergedBatch& batch, MergedTask& merged, const nlohmann::json& evaluation) {
  const std::string& task = merged.task.name;
  if (!evaluation.contains("worst_frames")) return;  // of an earlier version
  const auto& worst = evaluation.at("worst_frames");
  const auto first = [&](const char* kind) {
    const auto& frames = worst.at(kind);
    return std::vector<nlohmann::json>(frames.begin(),
                                       frames.begin() + std::min<std::ptrdiff_t>(kMostOfATask, std::ssize(frames)));
  };
  for (const auto& frame : first("camera"))
    addWorst(
        batch.worst_camera_m, merged.worst.camera_m,
        {task, frame.at("frame"), frame.at("rpe_t_m"), fmt::format("{:.3f} deg", frame.at("rpe_r_deg").get<double>())});
  for (const auto& frame : first("objects"))
    addWorst(batch.worst_object_m, merged.worst.object_m,
             {task, frame.at("frame"), frame.at("me_t_m"),
              fmt::format("label {}, track {}", frame.at("label").get<int>(), frame.at("track_id").get<int>())});
}

/// Adds the frames of a run with the largest latency, each with the part that exceeds the median frame's most.
void addLatestFrames(MergedBatch& batch, MergedTask& merged, const std::vector<FrameRow>& rows) {
  for (const SlowFrame& slow : latencyReport(rows, kMostOfATask).slowest) {
    const std::string most = slow.above_median.empty() ? ""
                                                       : fmt::format("{} {:+.1f} ms", slow.above_median.front().name,
                                                                     slow.above_median.front().ms);
    addWorst(batch.latest_ms, merged.worst.latest_ms,
             {merged.task.name, slow.row.head.frame.value, slow.row.latency_ms, most});
  }
}

void addLatencies(std::map<double, std::int64_t>& latencies, const nlohmann::json& summary) {
  const nlohmann::json::json_pointer buckets("/latency_ms/buckets");
  if (summary.is_null() || !summary.contains(buckets)) return;
  for (const auto& bucket : summary.at(buckets)) latencies[bucket.at(0)] += bucket.at(1).get<std::int64_t>();
}

void readResult(MergedBatch& batch, MergedTask& merged, const fs::path& result) {
  const auto evaluation = jsonIn(evaluationIn(result)), summary = jsonIn(runIn(result) / "summary.json");
  const auto rows = readFrames(runIn(result) / "frames.csv");
  try {
    merged.values = measuresOf(evaluation, summary);
    merged.has_labels = evaluation.is_object() && evaluation.at("final").contains("detection");
    if (evaluation.is_object()) {
      addWorstErrors(batch, merged, evaluation);
      addReliability(batch.existence[merged.task.set], kExistenceClaim, evaluation);
      addReliability(batch.kinds[merged.task.set], kKindClaim, evaluation);
      addCovariances(batch.covariances[merged.task.set], evaluation);
    }
    addLatencies(batch.latencies[merged.task.set], summary);
  } catch (const nlohmann::json::exception& error) {
    throw InputError(result.string() + ": has a measure of another kind than expected (" +
                     printable(error.what(), 100) + "); remove it and run the batch again");
  }
  addLatestFrames(batch, merged, rows);
}

/// Reads a result. If it cannot be read, the others are merged all the same.
void readOrFail(MergedBatch& batch, MergedTask& merged, const fs::path& result) {
  try {
    readResult(batch, merged, result);
    merged.outcome = TaskOutcome::kDone;
  } catch (const InputError& error) {
    merged.outcome = TaskOutcome::kFailed;
    merged.record.failure = TaskFailure{.step = "merge", .message = error.what()};
    merged.values.assign(allMeasures().size(), kNoValue);
  }
}

MergedTask merge(MergedBatch& batch, const Task& task, const BatchFolder& folder) {
  MergedTask merged{.task = task};
  merged.values.assign(allMeasures().size(), kNoValue);
  if (auto record = finishedRecord(task, folder)) {
    merged.record = std::move(*record);
    readOrFail(batch, merged, folder.result(task.name));
  } else if (auto failed = failedRecord(task, folder)) {
    merged.outcome = TaskOutcome::kFailed;
    merged.record = std::move(*failed);
  }
  return merged;
}

/// Key that is equal for results to be compared with each other.
std::string pairKey(const Task& task) {
  return fmt::format("{}/{}/{}", task.drive, task.seed ? std::to_string(*task.seed) : "", task.repetition);
}

/// Sets the relative errors of a result against that of the baseline's set.
void compareWith(const Task& baseline, MergedTask& task, const BatchFolder& folder) {
  EvaluateOptions options;
  options.run = runIn(folder.result(task.task.name));
  options.baseline_run = runIn(folder.result(baseline.name));
  try {
    const auto compared = evaluateRun(options).objects_against_baseline;
    if (!compared || compared->objects_of_mean == 0) return;
    const auto set = [&](std::string_view name, PositionKind kind) {
      task.values[measureIndex(name)] = compared->mean_relative_error[static_cast<std::size_t>(kind)];
    };
    set("re_aligned", PositionKind::kAligned);
    set("re_offset_removed", PositionKind::kWorldOffsetRemoved);
    set("re_as_seen", PositionKind::kAsSeenOffsetRemoved);
  } catch (const UserError& error) {
    logWarning(fmt::format("{} is not compared with {}: {}", task.task.name, baseline.name, error.what()));
  }
}

void compareWithBaseline(MergedBatch& batch, const std::string& set) {
  const BatchFolder folder(batch.folder);
  std::map<std::string, const Task*> baselines;
  for (const MergedTask& task : batch.tasks)
    if (task.task.set == set && task.outcome == TaskOutcome::kDone) baselines[pairKey(task.task)] = &task.task;
  for (MergedTask& task : batch.tasks) {
    const auto baseline = baselines.find(pairKey(task.task));
    if (task.outcome != TaskOutcome::kDone || !task.has_labels || task.task.set == set) continue;
    if (baseline != baselines.end()) compareWith(*baseline->second, task, folder);
  }
}

}  // namespace

std::string_view outcomeName(TaskOutcome outcome) {
  switch (outcome) {
    case TaskOutcome::kDone:
      return "done";
    case TaskOutcome::kFailed:
      return "failed";
    case TaskOutcome::kMissing:
      return "missing";
  }
  return "";
}

void WorstFrameOfEach::add(const WorstFrameOfEach& other) {
  const auto keep = [](WorstFrame& mine, const WorstFrame& theirs) {
    if (!theirs.task.empty() && (mine.task.empty() || theirs.value > mine.value)) mine = theirs;
  };
  keep(camera_m, other.camera_m);
  keep(object_m, other.object_m);
  keep(latest_ms, other.latest_ms);
}

std::size_t MergedBatch::count(TaskOutcome outcome) const {
  return static_cast<std::size_t>(std::ranges::count(tasks, outcome, &MergedTask::outcome));
}

MergedBatch readBatch(const fs::path& folder, const std::string& baseline_set) {
  const BatchFolder batch_folder(folder);
  if (!fs::exists(batch_folder.plan()))
    throw InputError(folder.string() + ": is no folder of a batch; start one with motorcade batch MANIFEST --out " +
                     shellWord(folder.string()));
  MergedBatch batch{.folder = folder, .plan = readPlan(batch_folder.plan())};
  batch.plan.published = comparableFigures(batch.plan.published);
  for (const Task& task : batch.plan.tasks) batch.tasks.push_back(merge(batch, task, batch_folder));
  const std::string& baseline = baseline_set.empty() ? batch.plan.baseline_set : baseline_set;
  if (!baseline.empty()) compareWithBaseline(batch, baseline);
  return batch;
}

}  // namespace motorcade
