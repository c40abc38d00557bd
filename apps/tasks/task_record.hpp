#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace motorcade {

/// Name of this machine, as others know it.
std::string hostName();

/// Reason why an attempt at a task failed.
struct TaskFailure {
  std::string step{};     // render, run, evaluate, or the preparation of them
  std::string message{};  // a sentence
  int exit_code = 0;
  int signal = 0;  // that killed the step's process; 0 for none
  std::vector<std::string> last_lines{};
};

/// Record of an attempt at a task (task.json).
struct TaskRecord {
  std::string task{}, drive{}, set{};
  std::optional<std::uint32_t> seed{};
  int repetition = 1;
  std::filesystem::path sequence{};
  std::string fingerprint{};
  std::string rendering{};  // of a scene: which rendering of it was run
  std::string host{};
  std::vector<int> processors{};  // that its processes were kept to; empty for any
  std::string started{};          // UTC, ISO 8601
  double wall_s = 0, cpu_s = 0;   // of all its processes
  std::int64_t peak_memory_bytes = 0;
  std::optional<TaskFailure> failure{};
};

/// Throws OutputError.
void writeTaskRecord(const std::filesystem::path& file, const TaskRecord& record);
/// Throws InputError.
TaskRecord readTaskRecord(const std::filesystem::path& file);

}  // namespace motorcade
