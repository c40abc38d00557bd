#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace motorcade::perf {

/// Adds `pipeline_bench drive`: whether CPU time, the back-end's share and memory stay flat over a drive of any length.
/// `action` becomes what to do; it returns the exit code.
void addLongDrive(CLI::App& app, std::function<int()>& action);

}  // namespace motorcade::perf
