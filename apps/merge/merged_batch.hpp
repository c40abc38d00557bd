#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "apps/merge/measures.hpp"
#include "apps/merge/reliability_tables.hpp"
#include "apps/tasks/plan.hpp"
#include "apps/tasks/task_record.hpp"

namespace motorcade {

/// Outcome of a task.
enum class TaskOutcome { kDone, kFailed, kMissing };
std::string_view outcomeName(TaskOutcome outcome);

/// A frame to look at: one with a large error, or a late one.
struct WorstFrame {
  std::string task{};  // empty where there is none
  std::int64_t frame = 0;
  double value = 0;
  std::string more{};  // what else there is to say
};

/// One of each kind.
struct WorstFrameOfEach {
  WorstFrame camera_m{}, object_m{}, latest_ms{};
  /// Keeps the larger of both values.
  void add(const WorstFrameOfEach& other);
};

struct MergedTask {
  Task task{};
  TaskOutcome outcome = TaskOutcome::kMissing;
  TaskRecord record{};      // of one that is done or failed
  bool has_labels = false;  // the truth tells of objects
  MeasureValues values{};   // of one that is done
  WorstFrameOfEach worst{};
};

/// All results of a batch, of each no more than its measures.
struct MergedBatch {
  std::filesystem::path folder{};
  Plan plan{};
  std::vector<MergedTask> tasks{};
  std::vector<WorstFrame> worst_camera_m{}, worst_object_m{}, latest_ms{};  // the worst first
  std::map<std::string, std::map<double, std::int64_t>> latencies{};        // by set: frames up to so many milliseconds
  ReliabilityBySet existence{}, kinds{};                                    // of all tasks that are done
  CovarianceReliabilityBySet covariances{};

  std::size_t count(TaskOutcome outcome) const;
};

/// Reads what is finished; a result that cannot be read counts as failed. With a baseline set, each result is compared
/// with that set's of the same drive, seed and repetition. Throws InputError where the folder has no plan.
MergedBatch readBatch(const std::filesystem::path& folder, const std::string& baseline_set);

}  // namespace motorcade
