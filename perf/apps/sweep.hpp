#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace motorcade::perf {

/// Adds `pipeline_bench sweep`: throughput, CPU time and latency by threads, frames in flight and where the images come
/// from, and whether all give the same results. `action` becomes what to do; it gives the exit code.
void addSweep(CLI::App& app, std::function<int()>& action);

}  // namespace motorcade::perf
