#pragma once

#include <functional>

namespace motorcade {

/// What a command line asks for: an action that gives the exit code; or, where the parser has answered itself (help,
/// version, a usage error), no action but the exit code.
struct CommandLine {
  std::function<int()> action;
  int exit_code = 0;
};

CommandLine parseCommandLine(int argc, const char* const* argv);

}  // namespace motorcade
