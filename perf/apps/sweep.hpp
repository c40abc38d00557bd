#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace motorcade::perf {

/// Adds `pipeline_bench sweep`: throughput, CPU time and latency by threads, frames in flight and source of the images,
/// and whether all results are the same. `action` becomes what to do; it returns the exit code.
void addSweep(CLI::App& app, std::function<int()>& action);

}  // namespace motorcade::perf
