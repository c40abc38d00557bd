#include "apps/batch/local_lock.hpp"

#include <cerrno>
#include <csignal>
#include <string>

#include <unistd.h>

#include "apps/tasks/host_name.hpp"
#include "apps/tasks/task_json.hpp"
#include "io/files/line_file.hpp"

namespace motorcade {
namespace {

std::filesystem::path noteIn(const BatchFolder& folder) { return folder.path() / "runner.json"; }

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

}  // namespace motorcade
