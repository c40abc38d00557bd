#include "apps/tasks/task_performer.hpp"

#include <algorithm>
#include <csignal>
#include <cstring>
#include <system_error>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include "apps/console/child_process.hpp"
#include "apps/tasks/fingerprint.hpp"
#include "io/files/errors.hpp"
#include "io/files/file_descriptor.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

std::string now() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))); }

/// Renames a folder to its final name and replaces an existing one. If another process puts its own there meanwhile,
/// that one stays. True if ours is there.
bool putInPlace(const fs::path& from, const fs::path& to) {
  makeFolder(to.parent_path());
  fs::path before = from;
  before += ".before";
  std::error_code error;
  fs::rename(to, before, error);  // there may be none
  fs::rename(from, to, error);
  const bool ours = !error;
  const bool others = error == std::errc::directory_not_empty || error == std::errc::file_exists;
  std::error_code ignored;
  fs::remove_all(before, ignored);
  if (!ours && !others) throw OutputError(to.string() + ": cannot be put in place: " + error.message());
  if (!ours) fs::remove_all(from, ignored);
  return ours;
}

/// Stamp of the rendering of a scene in a folder; empty for a recorded drive, or where there is none.
std::string renderingOf(const Task& task) {
  return task.render_arguments.empty() || !fs::exists(task.sequence) ? "" : fileStamp(task.sequence / "poses.txt");
}

fs::path attemptFolder(const Task& task, const Workplace& workplace) {
  return workplace.folder.attempts() / (task.name + "~" + workplace.attempt);
}

/// The parts of a record that are known before the work.
TaskRecord recordOf(const Task& task, const Workplace& workplace) {
  TaskRecord record{.task = task.name,
                    .drive = task.drive,
                    .set = task.set,
                    .seed = task.seed,
                    .repetition = task.repetition,
                    .sequence = task.sequence,
                    .fingerprint = task.fingerprint,
                    .host = hostName(),
                    .processors = workplace.processors,
                    .started = now()};
  return record;
}

/// Run and evaluation; the names of files are relative to the attempt's folder, which is to be renamed.
bool runSteps(const Task& task, TaskSteps& steps) {
  std::vector<std::string> run{task.sequence.string(), "--out", "run"};
  run.insert(run.end(), task.run_arguments.begin(), task.run_arguments.end());
  if (!steps.run("run", run)) return false;
  if (!task.has_truth) return true;
  std::vector<std::string> evaluate{"run", "--json", "evaluation.json"};
  evaluate.insert(evaluate.end(), task.evaluate_arguments.begin(), task.evaluate_arguments.end());
  return steps.run("evaluate", evaluate);
}

/// Does all the work and returns its record. Empty when it was stopped.
std::optional<TaskRecord> work(const Task& task, const Workplace& workplace, const fs::path& attempt) {
  const auto start = std::chrono::steady_clock::now();
  TaskRecord record = recordOf(task, workplace);
  TaskSteps steps(workplace, attempt);
  if (!task.problem.empty())
    record.failure = TaskFailure{.step = "plan", .message = task.problem};
  else if (fileStamp(workplace.program) != workplace.program_stamp)
    record.failure = TaskFailure{.step = "plan",
                                 .message = workplace.program.string() +
                                            ": was changed since the tasks were planned; " + "start the batch again"};
  else if (auto failure = renderSequence(task, workplace))
    record.failure = std::move(failure);
  else if (!runSteps(task, steps))
    record.failure = steps.failure();
  if (steps.stopped()) return std::nullopt;
  record.rendering = renderingOf(task);
  record.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  record.cpu_s = steps.cpu_s();
  record.peak_memory_bytes = steps.peakMemory_bytes();
  return record;
}

std::optional<TaskRecord> recordOfSame(const Task& task, const fs::path& folder) {
  std::error_code none;
  if (!fs::exists(recordIn(folder), none)) return std::nullopt;
  try {
    TaskRecord record = readTaskRecord(recordIn(folder));
    if (record.fingerprint != task.fingerprint) return std::nullopt;
    const std::string rendering = renderingOf(task);
    if (!rendering.empty() && rendering != record.rendering) return std::nullopt;
    return record;
  } catch (const InputError&) {
    return std::nullopt;  // it is performed again
  }
}

using namespace std::chrono_literals;

constexpr auto kLook = 100ms;    // between two looks at whether to stop
constexpr auto kPatience = 20s;  // for a step that was told to end, to write what it has

std::string sentenceOn(const std::string& step, const ChildEnd& end) {
  if (end.signal == SIGKILL) return step + " was killed (signal 9), by somebody or for want of memory";
  if (end.signal != 0) return fmt::format("{} was ended by signal {} ({})", step, end.signal, ::strsignal(end.signal));
  return fmt::format("{} ended with exit code {}", step, end.exit_code);
}

/// Tells a step to end, and waits for it. Kills it if it does not end.
ChildEnd endOf(ChildProcess& child) {
  child.signal(SIGTERM);
  if (const auto end = child.wait(kPatience)) return *end;
  child.signal(SIGKILL);
  while (true)
    if (const auto end = child.wait(kPatience)) return *end;
}

/// The last lines of a text file, without what would disturb a terminal.
std::vector<std::string> lastLines(const fs::path& file) {
  constexpr std::size_t kMost = 8, kMostCharacters = 300;
  std::vector<std::string> last;
  try {
    for (const TextLine& line : readLines(file)) {
      last.push_back(printable(line.text, kMostCharacters));
      if (last.size() > kMost) last.erase(last.begin());
    }
  } catch (const InputError&) {
    return {};
  }
  return last;
}

}  // namespace

std::optional<TaskRecord> performTask(const Task& task, const Workplace& workplace) {
  const fs::path attempt = attemptFolder(task, workplace);
  std::error_code ignored;
  fs::remove_all(attempt, ignored);
  makeFolder(attempt);
  auto record = work(task, workplace, attempt);
  if (!record) {
    fs::remove_all(attempt, ignored);
    return std::nullopt;
  }
  const bool failed = record->failure.has_value();
  try {
    writeTaskRecord(recordIn(attempt), *record);
    putInPlace(attempt, failed ? workplace.folder.failure(task.name) : workplace.folder.result(task.name));
  } catch (const OutputError& error) {
    TaskRecord unwritten = *record;
    if (!failed) unwritten.failure = TaskFailure{.step = "record", .message = error.what()};
    return unwritten;
  }
  if (!failed) fs::remove_all(workplace.folder.failure(task.name), ignored);
  return record;
}

std::optional<TaskFailure> renderSequence(const Task& task, const Workplace& workplace) {
  if (task.render_arguments.empty() || fs::exists(task.sequence)) return std::nullopt;
  fs::path attempt = task.sequence;
  attempt += "~" + workplace.attempt;
  std::error_code ignored;
  fs::remove_all(attempt, ignored);
  makeFolder(attempt);
  TaskSteps steps(workplace, attempt);
  std::vector<std::string> words{".", "--threads", std::to_string(task.threads)};
  words.insert(words.end(), task.render_arguments.begin(), task.render_arguments.end());
  if (!steps.run("synth", words)) {
    fs::remove_all(attempt, ignored);
    return steps.failure();
  }
  fs::rename(attempt, task.sequence, ignored);
  if (ignored) fs::remove_all(attempt, ignored);  // somebody else's is there: it is the same
  return std::nullopt;
}

std::optional<TaskRecord> finishedRecord(const Task& task, const BatchFolder& folder) {
  return recordOfSame(task, folder.result(task.name));
}

std::optional<TaskRecord> failedRecord(const Task& task, const BatchFolder& folder) {
  return recordOfSame(task, folder.failure(task.name));
}

TaskSteps::TaskSteps(const Workplace& workplace, std::filesystem::path folder)
    : workplace_(workplace), folder_(std::move(folder)) {}

bool TaskSteps::outOfTime() const { return workplace_.limit.count() > 0 && Clock::now() - start_ > workplace_.limit; }

bool TaskSteps::run(const std::string& step, const std::vector<std::string>& words) {
  ChildCommand command{.words = {workplace_.program.string(), step},
                       .folder = folder_,
                       .log = logIn(folder_),
                       .processors = workplace_.processors};
  command.words.insert(command.words.end(), words.begin(), words.end());
  ChildProcess child(command);
  std::optional<ChildEnd> end;
  bool late = false;
  while (!(end = child.wait(kLook)) && !stopped() && !(late = outOfTime())) continue;
  if (!end) end = endOf(child);
  cpu_s_ += end->cpu_s;
  peak_memory_bytes_ = std::max(peak_memory_bytes_, end->peak_memory_bytes);
  if (end->good()) return true;
  if (!stopped())
    failure_ = TaskFailure{
        .step = step,
        .message = late ? fmt::format("{} took longer than the {} s of --time", step, workplace_.limit.count())
                        : sentenceOn(step, *end),
        .exit_code = end->exit_code,
        .signal = end->signal,
        .last_lines = lastLines(logIn(folder_))};
  return false;
}

}  // namespace motorcade
