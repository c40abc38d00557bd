#include "apps/batch/batch_processes.hpp"

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdlib>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/tasks/task_json.hpp"
#include "apps/tasks/task_record.hpp"
#include "io/files/file_names.hpp"
#include "io/files/line_file.hpp"

namespace motorcade {
namespace {

std::filesystem::path noteIn(const BatchFolder& folder) { return folder.path() / "runner.json"; }

namespace fs = std::filesystem;

constexpr char kSeparator = '~';

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr ? value : "";
}

/// True unless the process is known to have ended. This machine cannot tell for those of others, which count as alive.
bool isAlive(const std::string& who) {
  const std::string ours = hostName() + "-";
  if (!who.starts_with(ours)) return true;
  int pid = 0;
  std::from_chars(who.data() + ours.size(), who.data() + who.size(), pid);
  return pid <= 0 || ::kill(pid, 0) == 0 || errno != ESRCH;
}

std::vector<Attempt> attemptsIn(const fs::path& folder) {
  std::vector<Attempt> attempts;
  for (const fs::path& entry : listFolderIfThere(folder)) {
    const std::string name = entry.filename().string();
    const auto separator = name.find(kSeparator);
    if (separator == std::string::npos) continue;
    const std::string who = name.substr(separator + 1);
    attempts.push_back({entry, name.substr(0, separator), who, isAlive(who)});
  }
  return attempts;
}

}  // namespace

LocalLock::LocalLock(const BatchFolder& folder) : note_(noteIn(folder)), lock_(folder.path()) {
  writeAtOnce(note_, textOf({{"host", hostName()}, {"pid", ::getpid()}}));
}

LocalLock::~LocalLock() {
  std::error_code ignored;
  std::filesystem::remove(note_, ignored);
}

std::optional<LocalRunnerNote> localRunnerOf(const BatchFolder& folder) {
  std::error_code none;
  if (!std::filesystem::exists(noteIn(folder), none)) return std::nullopt;
  auto note = readJson<LocalRunnerNote>(noteIn(folder), "a note on who runs a batch", [](const Json& json) {
    return LocalRunnerNote{.host = json.at("host"), .pid = json.at("pid")};
  });
  note.here = note.host == hostName();
  if (note.here && ::kill(note.pid, 0) != 0 && errno == ESRCH) return std::nullopt;  // it was killed
  return note;
}

std::string localAttemptName(std::size_t slot) { return fmt::format("{}-{}-{}", hostName(), ::getpid(), slot); }

std::string slurmAttemptName() {
  const std::string job = environment("SLURM_ARRAY_JOB_ID"), index = environment("SLURM_ARRAY_TASK_ID");
  const std::string restart = environment("SLURM_RESTART_COUNT");
  if (job.empty() || index.empty()) return "";
  return fmt::format("slurm-{}_{}-{}-{}", job, index, restart.empty() ? "0" : restart, ::getpid());
}

std::vector<Attempt> attemptsOf(const BatchFolder& folder) { return attemptsIn(folder.attempts()); }

void removeDeadAttempts(const fs::path& folder) {
  std::error_code ignored;
  for (const Attempt& attempt : attemptsIn(folder))
    if (!attempt.alive) fs::remove_all(attempt.folder, ignored);
}

void removeEarlierRestarts(const BatchFolder& folder, const std::string& slurm_attempt) {
  const auto restart_end = slurm_attempt.rfind('-');
  const auto restart = slurm_attempt.rfind('-', restart_end - 1) + 1;
  const std::string element = slurm_attempt.substr(0, restart);
  const int ours = std::atoi(slurm_attempt.c_str() + restart);
  std::error_code ignored;
  for (const Attempt& attempt : attemptsOf(folder))
    if (attempt.who.starts_with(element) && std::atoi(attempt.who.c_str() + restart) < ours)
      fs::remove_all(attempt.folder, ignored);
}

}  // namespace motorcade
