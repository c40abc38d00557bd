#include "apps/batch/slurm.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "apps/console/child_process.hpp"
#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

[[noreturn]] void fail(const std::string& text) {
  throw UsageError("--time " + text + ": write minutes, H:MM:SS or D-HH:MM:SS");
}

/// The numbers between the colons.
std::vector<int> numbersIn(std::string_view text, const std::string& whole) {
  constexpr int kMost = 1'000'000;
  std::vector<int> numbers;
  for (std::string_view rest = text;;) {
    const std::string_view digits = rest.substr(0, rest.find(':'));
    int number = -1;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error != std::errc() || end != digits.data() + digits.size() || number < 0 || number > kMost) fail(whole);
    numbers.push_back(number);
    if (digits.size() == rest.size()) return numbers;
    rest.remove_prefix(digits.size() + 1);
  }
}

/// Quotes a text as one word of a shell.
std::string quoted(const std::string& text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

std::string headOf(const std::string& name, const std::filesystem::path& log, const SlurmOptions& options) {
  std::string head = "#!/bin/sh\n";
  const auto add = [&](const std::string& line) { head += "#SBATCH " + line + "\n"; };
  add("--job-name=motorcade-" + name);
  add("--output=" + log.string());
  add("--open-mode=append");
  if (!options.partition.empty()) add("--partition=" + options.partition);
  return head;
}

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr std::size_t kDefaultArray = 1001;
constexpr int kNotFound = 127;

struct Answer {
  int exit_code = 0;
  std::string text{};  // of both outputs
};

/// Runs one of Slurm's programs, for two minutes at most.
Answer ask(std::vector<std::string> words) {
  const ChildOutput output;
  words.insert(words.begin(), "/usr/bin/env");
  ChildProcess child({.words = words, .output = output.descriptor()});
  const auto end = child.wait(120s);
  if (!end) return {.exit_code = 1, .text = words[1] + " did not answer within two minutes"};
  std::string text = output.text();
  text.erase(text.find_last_not_of(" \n") + 1);
  return {.exit_code = end->signal != 0 ? 1 : end->exit_code, .text = text};
}

[[noreturn]] void failWith(const std::string& program, const Answer& answer) {
  if (answer.exit_code == kNotFound)
    throw UsageError(program + " is not there; run this where Slurm is installed, or without --slurm");
  throw UsageError(program + ": " + printable(answer.text, 500));
}

std::string joined(const std::vector<std::string>& words, const char* separator) {
  return fmt::format("{}", fmt::join(words, separator));
}

/// Parses a line JOB|INDEX|STATE|REASON; the index of a job without elements is N/A.
QueuedElement elementOf(const std::string& line) {
  std::istringstream fields(line);
  QueuedElement element;
  std::string index;
  std::getline(fields, element.job, '|');
  std::getline(fields, index, '|');
  std::getline(fields, element.state, '|');
  std::getline(fields, element.reason, '|');
  std::from_chars(index.data(), index.data() + index.size(), element.index);
  return element;
}

}  // namespace

std::chrono::seconds taskTime(const std::string& text) {
  using namespace std::chrono;
  if (text.empty()) return seconds(0);
  const auto dash = text.find('-');
  const bool with_days = dash != std::string::npos;
  auto numbers = numbersIn(std::string_view(text).substr(with_days ? dash + 1 : 0), text);
  if (numbers.size() > 3) fail(text);
  seconds total(0);
  if (with_days) {
    total += hours(24 * numbersIn(std::string_view(text).substr(0, dash), text).front());
    numbers.resize(3, 0);
  } else if (numbers.size() < 3) {  // minutes, with seconds or without
    numbers.insert(numbers.begin(), 0);
    numbers.resize(3, 0);
  }
  total += hours(numbers[0]) + minutes(numbers[1]) + seconds(numbers[2]);
  if (total <= seconds(0)) fail(text);
  return total;
}

void requireWritableInScript(const std::filesystem::path& path) {
  constexpr const char* kUnwritable = " \t\n\r\"'\\%#";
  if (path.string().find_first_of(kUnwritable) != std::string::npos)
    throw UsageError(path.string() + ": Slurm's scripts cannot name this folder; choose one without blanks, quotes, " +
                     "backslashes, % and #");
}

std::string SlurmScripts::array(const SlurmArray& array) const {
  std::string text = headOf(array.name, submission / (array.name + "_%a.log"), options);
  const auto add = [&](const std::string& line) { text += "#SBATCH " + line + "\n"; };
  const std::string limit = options.array_limit > 0 ? fmt::format("%{}", options.array_limit) : "";
  add(fmt::format("--array=0-{}{}", array.count - 1, limit));
  add(fmt::format("--nodes=1 --ntasks=1 --cpus-per-task={}", threads));
  add(fmt::format("--mem={}M", options.memory_mb));
  if (!options.time.empty()) add("--time=" + options.time);
  add("--requeue");           // after the loss of a node
  add("--signal=B:TERM@30");  // 30 s before the end of its time a task is told to end
  text += fmt::format("exec {} batch task {} --list {} --index $(({} + SLURM_ARRAY_TASK_ID)){}\n",
                      quoted(program.string()), quoted(batch.string()), quoted(array.list.string()), array.first,
                      array.only_render ? " --render" : "");
  return text;
}

std::string SlurmScripts::merge() const {
  return headOf("merge", submission / "merge.log", options) + "#SBATCH --ntasks=1\n" +
         fmt::format("#SBATCH --mem={}M\n", options.memory_mb) +
         fmt::format("exec {} batch merge {}\n", quoted(program.string()), quoted(batch.string()));
}

std::string submitScript(const fs::path& script, const std::vector<std::string>& after) {
  std::vector<std::string> words{"sbatch", "--parsable"};
  if (!after.empty()) words.push_back("--dependency=afterany:" + joined(after, ":"));
  words.push_back(script.string());
  const Answer answer = ask(words);
  // The output may have warnings before the number, and a semicolon and the name of a cluster behind it.
  const std::string line = answer.text.substr(answer.text.find_last_of('\n') + 1);
  std::string job = line.substr(0, line.find(';'));
  if (answer.exit_code != 0 || job.empty() ||
      !std::ranges::all_of(job, [](unsigned char c) { return std::isdigit(c); }))
    failWith("sbatch", answer);
  return job;
}

std::size_t largestArray() {
  const Answer answer = ask({"scontrol", "show", "config"});
  const auto key = answer.text.find("MaxArraySize");
  const auto digits = key == std::string::npos ? key : answer.text.find_first_of("0123456789", key);
  std::size_t size = 0;
  if (digits != std::string::npos)
    std::from_chars(answer.text.data() + digits, answer.text.data() + answer.text.size(), size);
  return size > 0 ? size : kDefaultArray;
}

std::optional<std::vector<QueuedElement>> queuedElements(const std::vector<std::string>& jobs) {
  std::vector<QueuedElement> elements;
  if (jobs.empty()) return elements;
  const Answer answer = ask({"squeue", "--noheader", "--array", "--format=%F|%K|%T|%r", "--jobs=" + joined(jobs, ",")});
  if (answer.text.find("Invalid job id") != std::string::npos) return elements;  // it has forgotten all of them
  if (answer.exit_code != 0) return std::nullopt;
  std::istringstream lines(answer.text);
  for (std::string line; std::getline(lines, line);) elements.push_back(elementOf(line));
  return elements;
}

void cancelJobs(const std::vector<std::string>& jobs) {
  std::vector<std::string> words{"scancel"};
  words.insert(words.end(), jobs.begin(), jobs.end());
  if (const Answer answer = ask(words); answer.exit_code != 0) failWith("scancel", answer);
}

}  // namespace motorcade
