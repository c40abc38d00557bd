#include "apps/batch/slurm_submission.hpp"

#include <algorithm>
#include <iostream>
#include <set>

#include <nlohmann/json.hpp>

#include "apps/console/own_program.hpp"
#include "apps/tasks/task_json.hpp"
#include "io/files/errors.hpp"
#include "io/files/line_file.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

Json jsonOf(const SlurmSubmission& submission) {
  Json jobs = Json::array();
  for (const auto& job : submission.jobs)
    jobs.push_back({{"id", job.id},
                    {"name", job.array.name},
                    {"list", job.array.list.string()},
                    {"first", job.array.first},
                    {"count", job.array.count},
                    {"only_render", job.array.only_render}});
  return {{"jobs", std::move(jobs)}};
}

SlurmSubmission submissionOf(const Json& json) {
  SlurmSubmission submission;
  for (const Json& job : json.at("jobs"))
    submission.jobs.push_back({.id = job.at("id"),
                               .array = {.name = job.at("name"),
                                         .list = job.at("list").get<std::string>(),
                                         .first = job.at("first"),
                                         .count = job.at("count"),
                                         .only_render = job.at("only_render")}});
  return submission;
}

fs::path jobsIn(const fs::path& submission) { return submission / "jobs.json"; }

/// Creates the folder with the next free number.
fs::path newSubmissionFolder(const BatchFolder& folder) {
  std::error_code error;
  fs::create_directories(folder.cluster(), error);
  for (int number = 1;; ++number) {
    fs::path submission = folder.cluster() / std::to_string(number);
    if (fs::create_directory(submission, error)) return submission;
    if (error) throw OutputError(submission.string() + ": cannot be made: " + error.message());
  }
}

void writeList(const fs::path& file, const std::vector<const Task*>& tasks) {
  std::string names;
  for (const Task* const task : tasks) names += task->name + "\n";
  writeAtOnce(file, names);
}

/// One task for each sequence that must be rendered.
std::vector<const Task*> tasksToRender(const std::vector<const Task*>& tasks) {
  std::vector<const Task*> first;
  std::set<fs::path> seen;
  for (const Task* const task : tasks)
    if (task->problem.empty() && !task->render_arguments.empty() && !fs::exists(task->sequence) &&
        seen.insert(task->sequence).second)
      first.push_back(task);
  return first;
}

/// Writes scripts of one submission, and submits or prints them.
class Submitter {
 public:
  Submitter(SlurmScripts scripts, fs::path folder)
      : scripts_(std::move(scripts)), largest_(largestArray()), submission_{.folder = std::move(folder)} {}

  /// Adds an array for these tasks, or several where Slurm allows none of that size.
  std::vector<std::string> addArrays(const std::string& name, const std::vector<const Task*>& tasks, bool only_render,
                                     const std::vector<std::string>& after) {
    const fs::path list = submission_.folder / (name + ".txt");
    if (!tasks.empty()) writeList(list, tasks);
    std::vector<std::string> ids;
    for (std::size_t first = 0; first < tasks.size(); first += largest_) {
      const SlurmArray array{.name = name + "-" + std::to_string(first / largest_),
                             .list = list,
                             .first = first,
                             .count = std::min(largest_, tasks.size() - first),
                             .only_render = only_render};
      add({.id = "", .array = array}, scripts_.array(array), after);
      ids.push_back(submission_.jobs.back().id);
    }
    return ids;
  }

  void addMerge(const std::vector<std::string>& after) {
    add({.id = "", .array = {.name = "merge"}}, scripts_.merge(), after);
  }

  SlurmSubmission submission() { return std::move(submission_); }

 private:
  void add(SlurmSubmission::Job job, const std::string& script, const std::vector<std::string>& after) {
    const fs::path file = submission_.folder / (job.array.name + ".sh");
    writeAtOnce(file, script);
    if (scripts_.options.dry_run) {
      std::cout << "# " << file.string() << "\n" << script << "\n";
    } else {
      job.id = submitScript(file, after);
    }
    submission_.jobs.push_back(std::move(job));
    if (!scripts_.options.dry_run) writeAtOnce(jobsIn(submission_.folder), textOf(jsonOf(submission_)));
  }

  SlurmScripts scripts_;
  std::size_t largest_;
  SlurmSubmission submission_;
};

}  // namespace

SlurmSubmission submitTasks(const std::vector<const Task*>& tasks, const BatchFolder& folder,
                            const SlurmOptions& options) {
  requireWritableInScript(folder.path());
  const fs::path submission = newSubmissionFolder(folder);
  int threads = 1;
  for (const Task* const task : tasks) threads = std::max(threads, task->threads);
  Submitter submitter({.program = ownProgram(),
                       .batch = folder.path(),
                       .submission = submission,
                       .threads = threads,
                       .options = options},
                      submission);
  const auto renders = submitter.addArrays("render", tasksToRender(tasks), true, {});
  const auto runs = submitter.addArrays("tasks", tasks, false, renders);
  submitter.addMerge(runs);
  return submitter.submission();
}

std::vector<SlurmSubmission> readSubmissions(const BatchFolder& folder) {
  std::vector<SlurmSubmission> submissions;
  std::error_code none;
  for (int number = 1;; ++number) {
    const fs::path submission = folder.cluster() / std::to_string(number);
    if (!fs::exists(submission, none)) return submissions;
    if (!fs::exists(jobsIn(submission), none)) continue;  // a dry run
    submissions.push_back(readJson<SlurmSubmission>(jobsIn(submission), "a list of Slurm's jobs", submissionOf));
    submissions.back().folder = submission;
  }
}

std::optional<std::map<std::string, QueuedElement>> queuedTasks(const BatchFolder& folder) {
  std::map<std::string, SlurmArray> arrays;  // by their jobs
  std::vector<std::string> jobs;
  for (const SlurmSubmission& submission : readSubmissions(folder))
    for (const auto& job : submission.jobs)
      if (job.array.count > 0 && !job.array.only_render) {
        arrays[job.id] = job.array;
        jobs.push_back(job.id);
      }
  std::map<std::string, QueuedElement> queued;
  std::map<fs::path, std::vector<std::string>> lists;
  auto elements = queuedElements(jobs);
  if (!elements) return std::nullopt;
  for (QueuedElement& element : *elements) {
    const SlurmArray& array = arrays[element.job];
    auto& names = lists[array.list];
    if (names.empty()) names = readTaskList(array.list);
    if (const std::size_t line = array.first + element.index; line < names.size())
      queued[names[line]] = std::move(element);
  }
  return queued;
}

std::vector<std::string> readTaskList(const fs::path& list) {
  std::vector<std::string> names;
  for (const TextLine& line : readLines(list)) names.push_back(line.text);
  return names;
}

}  // namespace motorcade
