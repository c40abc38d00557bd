#include "perf/apps/long_drive.hpp"

#include <cstdio>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "perf/apps/bench_options.hpp"
#include "perf/apps/heap_use.hpp"
#include "perf/apps/playback.hpp"
#include "perf/support/process_memory.hpp"

namespace motorcade::perf {
namespace {

constexpr double kMegabyte = 1e6;

struct LongDriveOptions {
  BenchOptions bench;
  int every = 1000;
};

/// Prints a row after every so many frames.
class DriveTable {
 public:
  explicit DriveTable(int every) : every_(every), start_(processUsage()) {
    std::printf("%8s | %9s %9s | %10s %10s %9s | %8s %8s %8s | %11s %9s %11s\n", "frame", "frames/s", "CPU ms",
                "back-end", "share", "objects", "heap MB", "RSS MB", "peak MB", "factors", "stolen s", "inv. switch");
  }

  void note(const PipelineResult& result) {
    if (frames_ == 0) since_ = result.timing.published;
    ++frames_;
    if (static_cast<std::size_t>(frames_) % kFramesPerTrim == 0) giveBackSpareMemory();
    backend_ms_ += result.timing.of(Stage::kIncrementalOptimization).cpu_ms;
    objects_ += static_cast<double>(result.online.objects.size());
    if (frames_ % every_ == 0) print(result);
  }

 private:
  void print(const PipelineResult& result) {
    const ProcessUsage now = processUsage(), used = now.since(start_);
    const double frames = every_, cpu_ms = 1e3 * used.cpu_s / frames, backend_ms = backend_ms_ / frames;
    std::printf("%8lld | %9.1f %9.2f | %7.2f ms %8.1f %% %9.1f | %8.1f %8.0f %8.0f | %11lld %9.2f %11lld\n",
                static_cast<long long>(frames_), 1e3 * frames / millisecondsBetween(since_, result.timing.published),
                cpu_ms, backend_ms, 100 * backend_ms / cpu_ms, objects_ / frames,
                static_cast<double>(heapUse_bytes()) / kMegabyte, static_cast<double>(residentBytes()) / kMegabyte,
                static_cast<double>(now.peak_memory_bytes) / kMegabyte, static_cast<long long>(result.counters.factors),
                used.stolen_s, static_cast<long long>(used.involuntary_switches));
    std::fflush(stdout);
    start_ = now;
    since_ = result.timing.published;
    backend_ms_ = objects_ = 0;
  }

  int every_;
  std::int64_t frames_ = 0;
  ProcessUsage start_;
  SteadyTime since_;
  double backend_ms_ = 0, objects_ = 0;
};

int drive(const LongDriveOptions& options) {
  const PipelineConfig config = configOf(options.bench);
  const HeldDrive held(driveOf(options.bench));
  const Sequence sequence = driveOf(options.bench);
  std::printf("%s: %zu pairs from memory, %d threads, %d in flight; means over %d frames each\n\n",
              options.bench.sequence.c_str(), held.size(), config.pipeline.threads, config.pipeline.frames_in_flight,
              options.every);
  DriveTable table(options.every);
  const auto source = playHeld(held);
  PlaybackOptions playback;
  playback.observer = [&table](const PipelineResult& result) { table.note(result); };
  const Playback run = play(*source, config, makeStages(config, sequence.camera), playback);

  double backend_ms = run.stage_cpu_ms[static_cast<std::size_t>(Stage::kIncrementalOptimization)];
  std::printf("\nall      | %9.1f %9.2f | %7.2f ms %8.1f %%; %lld lost of %lld\n", run.rate_hz(),
              run.perFrame(1e3 * run.used.cpu_s), run.perFrame(backend_ms), 100 * backend_ms / (1e3 * run.used.cpu_s),
              static_cast<long long>(run.summary.lost), static_cast<long long>(run.frames()));
  return 0;
}

}  // namespace

void addLongDrive(CLI::App& app, std::function<int()>& action) {
  const auto options = std::make_shared<LongDriveOptions>();
  CLI::App* command =
      app.add_subcommand("drive", "CPU time, the back-end's share and memory along a drive of any length");
  addBenchOptions(*command, options->bench);
  command->add_option("--every", options->every, "Frames per row")->check(CLI::PositiveNumber)->capture_default_str();
  command->callback([options, &action] { action = [options] { return drive(*options); }; });
}

}  // namespace motorcade::perf
