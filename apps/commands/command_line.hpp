#pragma once

#include <functional>

namespace CLI {
class App;
}

/// The options of each command; what a command does is in the room of its name. Only the sources of this folder
/// include CLI11, which takes long to compile.
namespace motorcade {

/// The action of a command; returns the exit code.
using Action = std::function<int()>;

/// Each adds its command; when the command line names it, `action` is set.
void addRun(CLI::App& app, Action& action);
void addCheck(CLI::App& app, Action& action);
void addEvaluate(CLI::App& app, Action& action);
void addDraw(CLI::App& app, Action& action);
void addLatency(CLI::App& app, Action& action);
void addReport(CLI::App& app, Action& action);
void addExport(CLI::App& app, Action& action);
void addView(CLI::App& app, Action& action);
void addSynth(CLI::App& app, Action& action);
void addSolve(CLI::App& app, Action& action);
void addBatch(CLI::App& app, Action& action);
void addBridge(CLI::App& app, Action& action);  // where the program was built with Cyclone DDS

/// The action that a command line asks for, which returns the exit code. Where the parser has answered itself (help,
/// version, a usage error), there is no action but the exit code.
struct CommandLine {
  std::function<int()> action;
  int exit_code = 0;
};

CommandLine parseCommandLine(int argc, const char* const* argv);

}  // namespace motorcade
