#include "apps/batch/batch_command.hpp"

#include <algorithm>
#include <iostream>
#include <set>

#include <fmt/format.h>

#include "apps/batch/batch_processes.hpp"
#include "apps/batch/local_runner.hpp"
#include "apps/batch/slurm_submission.hpp"
#include "apps/console/log.hpp"
#include "apps/console/own_program.hpp"
#include "apps/console/stop_signals.hpp"
#include "apps/merge/merged_files.hpp"
#include "apps/tasks/manifest.hpp"
#include "apps/tasks/task_performer.hpp"
#include "io/files/errors.hpp"
#include "io/files/file_descriptor.hpp"
#include "io/files/file_names.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr int kExitFailedTasks = 6;

/// The tasks of a plan that are still to be performed, and the number of those that are not.
struct Remaining {
  std::vector<const Task*> tasks{};
  std::size_t finished = 0, failed = 0;  // before
};

Remaining remainingOf(const Plan& plan, const BatchFolder& folder, bool retry) {
  Remaining remaining;
  for (const Task& task : plan.tasks) {
    if (finishedRecord(task, folder))
      ++remaining.finished;
    else if (!retry && failedRecord(task, folder))
      ++remaining.failed;
    else
      remaining.tasks.push_back(&task);
  }
  return remaining;
}

Plan planFor(const BatchOptions& options, const BatchFolder& folder) {
  const Manifest manifest = readManifest(options.manifest, options.root);
  return planOf(manifest,
                {.program = options.program.empty() ? ownProgram() : absoluteFolder(options.program),
                 .sequences = options.sequences.empty() ? folder.sequences() : absoluteFolder(options.sequences),
                 .threads = options.threads,
                 .only = options.only});
}

/// The folders that scenes are rendered into.
std::set<fs::path> renderedInto(const Plan& plan) {
  std::set<fs::path> folders;
  for (const Task& task : plan.tasks)
    if (!task.render_arguments.empty()) folders.insert(task.sequence.parent_path());
  return folders;
}

/// Removes what processes left that no longer run, here or in Slurm.
void removeLost(const Plan& plan, const BatchFolder& folder) {
  removeDeadAttempts(folder.attempts());
  for (const fs::path& sequences : renderedInto(plan)) removeDeadAttempts(sequences);
  const auto queued = queuedTasks(folder);
  std::error_code ignored;
  for (const Attempt& attempt : attemptsOf(folder))
    if (attempt.bySlurm() && queued && !queued->contains(attempt.task)) fs::remove_all(attempt.folder, ignored);
}

LocalRunner::Options slotsFor(const BatchOptions& options) {
  const auto usable = usableProcessors();
  const int processors = std::max(1, static_cast<int>(usable.size()));
  const int jobs = options.jobs > 0 ? options.jobs : std::max(1, processors / options.threads);
  LocalRunner::Options runner{.slots = processorSlots(usable, jobs, options.threads),
                              .limit = taskTime(options.slurm_options.time)};
  if (runner.slots.front().empty())
    logWarning(fmt::format("{} tasks of {} threads at a time on {} processors: their times are not comparable", jobs,
                           options.threads, processors));
  return runner;
}

void tellFailures(const std::vector<TaskRecord>& failed) {
  constexpr std::size_t kMost = 10;
  for (std::size_t i = 0; i < std::min(kMost, failed.size()); ++i) {
    std::cout << failed[i].task << ": " << failed[i].failure->message << "\n";
    for (const std::string& line : failed[i].failure->last_lines) std::cout << "    " << line << "\n";
  }
  if (failed.size() > kMost) std::cout << "and " << failed.size() - kMost << " more\n";
}

/// Reports the drives that are not on the disk, each with its name, and where the first was looked for.
void tellLeftOut(const Plan& plan) {
  if (plan.left_out.empty()) return;
  std::string names;
  std::set<std::string> drives;
  for (const LeftOutDrive& drive : plan.left_out) names += (names.empty() ? "" : ", ") + drive.name;
  for (const Task& task : plan.tasks) drives.insert(task.drive);
  std::cout << plan.left_out.size() << " of " << plan.left_out.size() + drives.size()
            << " drives are not on the disk and left out: " << names << "\n(" << plan.left_out.front().name
            << " was looked for at " << plan.left_out.front().looked_for << ")\n";
}

int performHere(const BatchOptions& options, const Plan& plan, const BatchFolder& folder, const Remaining& remaining) {
  StopSignals signals;
  LocalRunner runner(plan, folder, slotsFor(options));
  LocalOutcome outcome;
  {
    const auto watch = signals.watch([&] { runner.stop(); });
    outcome = runner.perform(remaining.tasks);
  }
  const std::size_t failed = outcome.failed.size() + remaining.failed;
  tellFailures(outcome.failed);
  std::cout << plan.tasks.size() << " tasks: " << outcome.done << " done, " << remaining.finished
            << " finished before, " << failed << " failed";
  if (remaining.failed > 0) std::cout << ", " << remaining.failed << " of them before (--retry tries them again)";
  std::cout << "\n";
  if (signals.received() != 0) return kExitSignal + signals.received();
  if (outcome.done + remaining.finished > 0) runMerge({.batch = folder.path()});
  return failed > 0 ? kExitFailedTasks : 0;
}

int performInSlurm(const BatchOptions& options, const BatchFolder& folder, Remaining remaining) {
  const auto queued = queuedTasks(folder);
  const auto waiting =
      std::erase_if(remaining.tasks, [&](const Task* task) { return queued && queued->contains(task->name); });
  if (waiting > 0) std::cout << waiting << " tasks are in Slurm's queue already\n";
  if (remaining.tasks.empty()) {
    std::cout << "nothing is left to submit; see motorcade batch status " << shellWord(folder.path().string()) << "\n";
    return 0;
  }
  const SlurmSubmission submission = submitTasks(remaining.tasks, folder, options.slurm_options);
  if (options.slurm_options.dry_run) {
    std::cout << "# nothing was submitted; the scripts are in " << submission.folder.string() << "\n";
    return 0;
  }
  std::cout << remaining.tasks.size() << " tasks submitted, " << remaining.finished << " finished before, "
            << remaining.failed << " failed before; see motorcade batch status " << shellWord(folder.path().string())
            << "\n";
  return 0;
}

const Task& taskNamed(const Plan& plan, const std::string& name, const fs::path& list) {
  const auto task = std::ranges::find(plan.tasks, name, &Task::name);
  if (task == plan.tasks.end())
    throw InputError(list.string() + ": task " + name + " is no longer in the plan; submit the batch again");
  return *task;
}

/// Performs one task, which ends early when a signal comes.
int perform(const Task& task, Workplace workplace, bool only_render) {
  std::atomic<bool> stop = false;
  workplace.stop = &stop;
  StopSignals signals;
  std::optional<TaskFailure> failure;
  {
    const auto watch = signals.watch([&] { stop = true; });
    if (only_render)
      failure = renderSequence(task, workplace);
    else if (const auto record = performTask(task, workplace))
      failure = record->failure;
  }
  if (signals.received() != 0) return kExitSignal + signals.received();
  if (failure) {
    logError(fmt::format("{}: {}", task.name, failure->message));
    for (const std::string& line : failure->last_lines) logError(fmt::format("    {}", line));
  } else {
    logInfo(fmt::format("{}: {}", task.name, only_render ? "rendered" : "done"));
  }
  return failure ? kExitFailedTasks : 0;
}

}  // namespace

int runBatch(const BatchOptions& options) {
  const BatchFolder folder(options.out);
  if (options.slurm) requireWritableInScript(folder.path());
  const Plan plan = planFor(options, folder);
  makeFolder(folder.path());
  std::optional<LocalLock> lock;
  if (!options.slurm) lock.emplace(folder);
  writePlan(folder.plan(), plan);
  tellLeftOut(plan);
  removeLost(plan, folder);
  const Remaining remaining = remainingOf(plan, folder, options.retry);
  return options.slurm ? performInSlurm(options, folder, remaining) : performHere(options, plan, folder, remaining);
}

int runBatchTask(const BatchTaskOptions& options) {
  const BatchFolder folder(options.batch);
  const auto names = readTaskList(options.list);
  if (options.index >= names.size())
    throw InputError(options.list.string() + ": has " + std::to_string(names.size()) + " tasks, none of number " +
                     std::to_string(options.index));
  const Plan plan = readPlan(folder.plan());
  const Task& task = taskNamed(plan, names[options.index], options.list);
  const std::string slurm = slurmAttemptName();
  if (!slurm.empty()) removeEarlierRestarts(folder, slurm);
  if (!options.only_render && finishedRecord(task, folder)) {
    logInfo(fmt::format("{}: finished before", task.name));
    return 0;
  }
  return perform(task,
                 {.folder = folder,
                  .program = plan.program,
                  .program_stamp = plan.program_stamp,
                  .attempt = slurm.empty() ? localAttemptName(0) : slurm,
                  .processors = usableProcessors()},
                 options.only_render);
}

}  // namespace motorcade
