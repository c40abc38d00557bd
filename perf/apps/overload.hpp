#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace motorcade::perf {

/// Adds `pipeline_bench overload`: latency and drops of the live policy when the camera is faster than the pipeline,
/// and after stalls. `action` becomes what to do; it returns the exit code.
void addOverload(CLI::App& app, std::function<int()>& action);

}  // namespace motorcade::perf
