#include "apps/merge/merge_command.hpp"

#include <iostream>

#include "apps/merge/merged_files.hpp"
#include "apps/merge/published_tables.hpp"
#include "apps/tasks/batch_folder.hpp"
#include "io/files/errors.hpp"
#include "io/files/line_file.hpp"

namespace motorcade {
namespace {

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

}  // namespace

int runMerge(const MergeOptions& options) {
  const Merged merged = mergedOf(options);
  const fs::path out = options.out.empty() ? BatchFolder(options.batch).merged() : options.out;
  std::error_code error;
  fs::create_directories(out, error);
  if (error) throw OutputError(out.string() + ": cannot be made: " + error.message());
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
