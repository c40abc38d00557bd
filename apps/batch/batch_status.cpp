#include <csignal>
#include <iostream>
#include <map>
#include <set>

#include <fmt/format.h>

#include "apps/batch/batch_command.hpp"
#include "apps/batch/batch_processes.hpp"
#include "apps/batch/slurm.hpp"
#include "apps/batch/slurm_submission.hpp"
#include "apps/batch/time_left.hpp"
#include "apps/tasks/task_json.hpp"
#include "apps/tasks/task_performer.hpp"
#include "io/files/errors.hpp"
#include "io/files/file_names.hpp"
#include "io/files/line_file.hpp"

namespace motorcade {
namespace {

/// One task's state and a remark on it.
struct TaskState {
  std::string task{};
  std::string state{};  // done, failed, running, queued or waiting
  std::string text{};
};

BatchFolder openBatch(const std::filesystem::path& path) {
  BatchFolder folder(path);
  if (!std::filesystem::exists(folder.plan()))
    throw InputError(path.string() + ": is no folder of a batch; start one with motorcade batch MANIFEST --out " +
                     shellWord(path.string()));
  return folder;
}

class StateReader {
 public:
  explicit StateReader(const BatchFolder& folder) : folder_(folder) {
    auto queued = queuedTasks(folder);
    slurm_answers_ = queued.has_value();
    if (queued) queued_ = std::move(*queued);
    for (const Attempt& attempt : attemptsOf(folder)) attempts_[attempt.task] = attempt;
  }

  TaskState of(const Task& task) const {
    if (finishedRecord(task, folder_)) return {task.name, "done", ""};
    const auto queued = queued_.find(task.name);
    const bool in_slurm = queued != queued_.end();
    const auto attempt = attempts_.find(task.name);
    const bool lost = attempt != attempts_.end() &&
                      (!attempt->second.alive || (attempt->second.bySlurm() && slurm_answers_ && !in_slurm));
    if (attempt != attempts_.end() && !lost)
      return {task.name, "running",
              fmt::format("{:.0f} of {} frames, {}", framesWritten(runIn(attempt->second.folder)), task.frames,
                          attempt->second.who)};
    if (in_slurm) return {task.name, "queued", queued->second.state + " " + queued->second.reason};
    if (const auto record = failedRecord(task, folder_)) return {task.name, "failed", record->failure->message};
    return {task.name, "waiting", lost ? "an attempt was lost: " + attempt->second.who : ""};
  }

 private:
  const BatchFolder& folder_;
  bool slurm_answers_ = false;
  std::map<std::string, QueuedElement> queued_;
  std::map<std::string, Attempt> attempts_;
};

std::string whoRuns(const BatchFolder& folder) {
  const auto runner = localRunnerOf(folder);
  return runner ? fmt::format("motorcade batch, process {} on {}", runner->pid, runner->host) : "";
}

void print(const std::vector<TaskState>& states, const std::string& runner) {
  std::map<std::string, int> counts;
  for (const TaskState& state : states) ++counts[state.state];
  std::cout << states.size() << " tasks";
  for (const char* const state : {"done", "failed", "running", "queued", "waiting"})
    if (counts[state] > 0) std::cout << ", " << counts[state] << " " << state;
  std::cout << "\n";
  if (!runner.empty()) std::cout << "performed by " << runner << "\n";
  constexpr int kMostQueued = 5;
  int queued = 0;
  for (const TaskState& state : states) {
    if (state.text.empty() || (state.state == "queued" && ++queued > kMostQueued)) continue;
    std::cout << fmt::format("  {:<8} {}: {}\n", state.state, state.task, state.text);
  }
}

}  // namespace

int runBatchStatus(const BatchStatusOptions& options) {
  const BatchFolder folder = openBatch(options.batch);
  const Plan plan = readPlan(folder.plan());
  const StateReader reader(folder);
  std::vector<TaskState> states;
  for (const Task& task : plan.tasks) states.push_back(reader.of(task));
  print(states, whoRuns(folder));
  if (options.json.empty()) return 0;
  Json json = Json::array();
  for (const TaskState& state : states)
    json.push_back({{"task", state.task}, {"state", state.state}, {"text", state.text}});
  writeAtOnce(options.json, textOf({{"performed_by", whoRuns(folder)}, {"tasks", std::move(json)}}));
  return 0;
}

int runBatchCancel(const std::filesystem::path& batch) {
  const BatchFolder folder = openBatch(batch);
  bool anything = false;
  if (const auto runner = localRunnerOf(folder)) {
    if (!runner->here)
      throw UsageError(folder.path().string() + ": is performed on " + runner->host + "; cancel it there");
    ::kill(runner->pid, SIGTERM);
    std::cout << "told process " << runner->pid << " to end\n";
    anything = true;
  }
  std::vector<std::string> jobs;
  for (const SlurmSubmission& submission : readSubmissions(folder))
    for (const auto& job : submission.jobs) jobs.push_back(job.id);
  std::set<std::string> waiting;
  const auto queued = queuedElements(jobs);
  if (!queued)
    throw UsageError("squeue does not answer: jobs " + fmt::format("{}", fmt::join(jobs, ", ")) + " may go on");
  for (const QueuedElement& element : *queued) waiting.insert(element.job);
  if (!waiting.empty()) {
    cancelJobs({waiting.begin(), waiting.end()});
    std::cout << "cancelled " << fmt::format("{}", fmt::join(waiting, ", ")) << " in Slurm\n";
    anything = true;
  }
  if (!anything) std::cout << "nothing of this batch runs or waits\n";
  return 0;
}

}  // namespace motorcade
