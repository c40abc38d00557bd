#include "apps/batch/slurm_commands.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/tasks/child_process.hpp"
#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr std::size_t kDefaultArray = 1001;
constexpr int kNotFound = 127;

struct Answer {
  int exit_code = 0;
  std::string text{};  // of both outputs
};

/// A file that is removed with this object.
class TemporaryFile {
 public:
  TemporaryFile() : file_(fs::temp_directory_path() / "motorcade_XXXXXX") {
    std::string name = file_.string();
    const int descriptor = ::mkstemp(name.data());
    if (descriptor < 0) throw OutputError(name + ": no temporary file can be made");
    ::close(descriptor);
    file_ = name;
  }
  ~TemporaryFile() {
    std::error_code ignored;
    fs::remove(file_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const fs::path& path() const { return file_; }

 private:
  fs::path file_;
};

/// Runs one of Slurm's programs, for two minutes at most.
Answer ask(std::vector<std::string> words) {
  const TemporaryFile output;
  words.insert(words.begin(), "/usr/bin/env");
  ChildProcess child({.words = words, .folder = fs::current_path(), .log = output.path()});
  const auto end = child.wait(120s);
  if (!end) return {.exit_code = 1, .text = words[1] + " did not answer within two minutes"};
  std::string text = readWhole(output.path());
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

}  // namespace

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

namespace {

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
