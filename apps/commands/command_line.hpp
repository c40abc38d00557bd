#pragma once

#include <functional>

namespace motorcade {

/// The action that a command line asks for, which returns the exit code. Where the parser has answered itself (help,
/// version, a usage error), there is no action but the exit code.
struct CommandLine {
  std::function<int()> action;
  int exit_code = 0;
};

CommandLine parseCommandLine(int argc, const char* const* argv);

}  // namespace motorcade
