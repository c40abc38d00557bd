#include "apps/tasks/task_steps.hpp"

#include <algorithm>
#include <csignal>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "apps/tasks/child_process.hpp"

namespace motorcade {
namespace {

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

}  // namespace

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
