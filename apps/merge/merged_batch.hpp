#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "apps/merge/measures.hpp"
#include "apps/tasks/plan.hpp"
#include "apps/tasks/task_record.hpp"

namespace motorcade {

/// What became of a task.
enum class TaskOutcome { kDone, kFailed, kMissing };
std::string_view outcomeName(TaskOutcome outcome);

struct MergedTask {
  Task task{};
  TaskOutcome outcome = TaskOutcome::kMissing;
  TaskRecord record{};      // of one that is done or failed
  bool has_labels = false;  // the truth tells of objects
  MeasureValues values{};   // of one that is done
};

/// A frame to look at: one with a large error, or a late one.
struct WorstFrame {
  std::string task{};
  std::int64_t frame = 0;
  double value = 0;
  std::string more{};  // what else there is to say
};

/// All results of a batch, of each no more than its measures.
struct MergedBatch {
  std::filesystem::path folder{};
  Plan plan{};
  std::vector<MergedTask> tasks{};
  std::vector<WorstFrame> worst_camera_m{}, worst_object_m{}, latest_ms{};  // the worst first
  std::map<std::string, std::map<double, std::int64_t>> latencies{};        // by set: frames up to so many milliseconds

  std::size_t count(TaskOutcome outcome) const;
};

/// Reads what is finished. With a baseline set, each result is compared with that set's of the same drive, seed and
/// repetition. Throws InputError naming the file.
MergedBatch readBatch(const std::filesystem::path& folder, const std::string& baseline_set);

}  // namespace motorcade
