#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/files/file_descriptor.hpp"

namespace motorcade {

/// A program to start: its own file first, then its arguments.
struct ChildCommand {
  std::vector<std::string> words{};
  std::filesystem::path folder{};  // that it works in; empty for this process'
  std::filesystem::path log{};     // that grows by what it prints and complains of; without it, `output` takes that
  std::vector<int> processors{};   // that it is kept to; empty for those of this thread
  int input = -1, output = -1;     // descriptors; without the first it reads nothing
};

/// Keeps in memory what a program prints.
class ChildOutput {
 public:
  /// Throws OutputError.
  ChildOutput();
  int descriptor() const { return file_.number(); }
  std::string text() const;

 private:
  FileDescriptor file_;
};

/// Exit and resource usage of a program.
struct ChildEnd {
  int exit_code = 0;
  int signal = 0;  // that killed it; 0 for none
  double cpu_s = 0;
  std::int64_t peak_memory_bytes = 0;

  bool good() const { return exit_code == 0 && signal == 0; }
};

/// A program that runs as a child of this process, in a process group of its own. Signals that a terminal sends to this
/// process' group do not reach it. It is told to end (SIGTERM) when the thread that started it ends.
class ChildProcess {
 public:
  /// Throws OutputError where the log cannot be written or no process can be started. A program that cannot be executed
  /// ends with exit code 127.
  explicit ChildProcess(const ChildCommand& command);
  /// Kills the program if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Sends a signal to the program and its children.
  void signal(int number);
  /// Waits for at most `patience`; empty while the program runs.
  std::optional<ChildEnd> wait(std::chrono::milliseconds patience);

 private:
  int pid_;
  FileDescriptor handle_;
  std::optional<ChildEnd> end_;
};

}  // namespace motorcade
