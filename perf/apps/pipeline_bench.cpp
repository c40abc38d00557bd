#include <cstdio>
#include <exception>
#include <functional>

#include <CLI/CLI.hpp>

#include "io/files/errors.hpp"
#include "perf/apps/long_drive.hpp"
#include "perf/apps/overload.hpp"
#include "perf/apps/sweep.hpp"

/// Measures the whole pipeline, as `motorcade run` wires it, on the pairs of a drive.
int main(int argc, char** argv) {
  constexpr int kExitUsage = 2, kExitInternal = 70;
  CLI::App app("Measures throughput, CPU time, latency and memory of the whole pipeline.", "pipeline_bench");
  app.require_subcommand(1);
  std::function<int()> action;
  motorcade::perf::addSweep(app, action);
  motorcade::perf::addLongDrive(app, action);
  motorcade::perf::addOverload(app, action);
  try {
    app.parse(argc, argv);
    return action();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kExitUsage;
  } catch (const motorcade::UserError& error) {
    std::fprintf(stderr, "pipeline_bench: %s\n", error.what());
    return error.exitCode();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "pipeline_bench: %s\n", error.what());
    return kExitInternal;
  }
}
