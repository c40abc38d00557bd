#include "perf/apps/sweep.hpp"

#include <bit>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "perf/apps/bench_options.hpp"
#include "perf/apps/playback.hpp"

namespace motorcade::perf {
namespace {

constexpr int kExitDifferent = 1;

struct SweepOptions {
  BenchOptions bench;
  std::vector<int> threads{1, 2}, in_flight{1, 2, 4, 6};
  std::vector<std::string> sources{"memory", "disk"};
  int repeat = 3;
  double rate_hz = 0;
};

/// One row of the table.
struct Cell {
  std::string source;
  int threads = 1, in_flight = 1;
  Playback best;  // the fastest of the repetitions
};

/// Everything that the cells of a sweep share.
struct Material {
  Sequence drive;
  PipelineConfig config;
  HeldDrive held;
  double decoding_cpu_ms = 0;
  std::optional<double> unit_ms;

  explicit Material(const SweepOptions& options)
      : drive(driveOf(options.bench)),
        config(configOf(options.bench)),
        held(drive),
        decoding_cpu_ms(decodingCpu_ms(drive)),
        unit_ms(perf::unit_ms(drive)) {}

  /// Formats CPU time as units, a column wide; empty where there is no unit.
  std::string units(double cpu_ms) const {
    char text[16] = "-";
    if (unit_ms) std::snprintf(text, sizeof text, "%.2f", cpu_ms / *unit_ms);
    return text;
  }
};

Playback playOnce(const Cell& cell, const Material& material, const SweepOptions& options) {
  PipelineConfig config = material.config;
  config.pipeline.threads = cell.threads;
  config.pipeline.frames_in_flight = cell.in_flight;
  const auto source = cell.source == "memory"
                          ? playHeld(material.held)
                          : playFromDisk(material.drive, std::bit_floor(static_cast<std::size_t>(cell.in_flight)));
  PlaybackOptions playback;
  if (options.rate_hz > 0) playback.rate_hz = options.rate_hz;
  return play(*source, config, makeStages(config, material.drive.camera), playback);
}

void printHead(const Material& material, const SweepOptions& options) {
  const StereoCamera& camera = material.drive.camera;
  std::printf("%s: %zu pairs of %d x %d px, the fastest of %d runs; decoding alone: %.2f ms of CPU per pair\n",
              options.bench.sequence.c_str(), material.drive.frames.size(), camera.width_px, camera.height_px,
              options.repeat, material.decoding_cpu_ms);
  if (material.unit_ms)
    std::printf("a unit is the CPU time in which libpng decodes a pair: %.2f ms here\n", *material.unit_ms);
  std::printf("latency from %s to publication\n\n", options.rate_hz > 0 ? "the moment a pair is due" : "admission");
  std::printf("%-7s %7s %9s %9s | %9s %10s %6s %6s | %7s %7s %7s %7s | %9s %11s\n", "images", "threads", "in flight",
              "frames/s", "CPU ms", "less dec.", "units", "less", "p50 ms", "p95", "p99", "max", "stolen s",
              "inv. switch");
}

void print(const Cell& cell, const Material& material) {
  const Playback& run = cell.best;
  const double cpu_ms = run.perFrame(1e3 * run.used.cpu_s);
  const double less_ms = cell.source == "disk" ? cpu_ms - material.decoding_cpu_ms : cpu_ms;
  const LatencyHistogram& latency = run.summary.latency;
  std::printf("%-7s %7d %9d %9.1f | %9.2f %10.2f %6s %6s | %7.1f %7.1f %7.1f %7.1f | %9.2f %11lld\n",
              cell.source.c_str(), cell.threads, cell.in_flight, run.rate_hz(), cpu_ms, less_ms,
              material.units(cpu_ms).c_str(), material.units(less_ms).c_str(), latency.percentile_ms(0.5),
              latency.percentile_ms(0.95), latency.percentile_ms(0.99), latency.max_ms(), run.used.stolen_s,
              static_cast<long long>(run.used.involuntary_switches));
  std::fflush(stdout);
}

/// Prints the costs of the stages. With one thread a stage's CPU time is all its work; with more, other workers help in
/// its parallel loops.
void printStages(const std::vector<Cell>& cells) {
  std::printf("\nper stage, CPU ms of the thread that ran it / wall ms\n%-7s %7s %9s", "images", "threads",
              "in flight");
  for (const auto& name : kStageKeys) std::printf(" %14.14s", std::string(name).c_str());
  std::printf("\n");
  for (const Cell& cell : cells) {
    std::printf("%-7s %7d %9d", cell.source.c_str(), cell.threads, cell.in_flight);
    for (std::size_t stage = 0; stage < kStageCount; ++stage)
      std::printf("  %6.2f / %4.1f", cell.best.perFrame(cell.best.stage_cpu_ms[stage]),
                  cell.best.perFrame(cell.best.stage_wall_ms[stage]));
    std::printf("\n");
  }
}

/// True when the results are those of the first playback.
bool sameResults(const Cell& cell, const ResultDigests& digests, const ResultDigests& reference) {
  const auto frame = firstDifference(digests, reference);
  if (frame)
    std::printf("DIFFERENT results from frame %zu on: %s, %d threads, %d in flight\n", *frame, cell.source.c_str(),
                cell.threads, cell.in_flight);
  return !frame;
}

int sweep(const SweepOptions& options) {
  const Material material(options);
  printHead(material, options);
  std::vector<Cell> cells;
  std::optional<ResultDigests> reference;
  bool same = true;
  const auto measure = [&](Cell& cell) {
    for (int repetition = 0; repetition < options.repeat; ++repetition) {
      Playback run = playOnce(cell, material, options);
      if (!reference) reference = run.digests;
      same = sameResults(cell, run.digests, *reference) && same;
      if (repetition == 0 || run.wall_s < cell.best.wall_s) cell.best = std::move(run);
    }
  };
  for (const std::string& source : options.sources) {
    for (const int threads : options.threads) {
      for (const int in_flight : options.in_flight) {
        Cell cell{.source = source, .threads = threads, .in_flight = in_flight, .best = {}};
        measure(cell);
        print(cell, material);
        cells.push_back(std::move(cell));
      }
    }
  }
  printStages(cells);
  std::printf("\nresults: %s\n", same ? "identical in all runs, camera and objects, online and final, bit by bit"
                                      : "DIFFERENT, see above");
  return same ? 0 : kExitDifferent;
}

}  // namespace

void addSweep(CLI::App& app, std::function<int()>& action) {
  const auto options = std::make_shared<SweepOptions>();
  CLI::App* command = app.add_subcommand("sweep", "Throughput, CPU time and latency by threads and frames in flight");
  addBenchOptions(*command, options->bench);
  command->add_option("--threads", options->threads, "Workers of the pipeline")
      ->delimiter(',')
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command->add_option("--in-flight", options->in_flight, "Frames in flight")
      ->delimiter(',')
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_option("--images", options->sources, "Where they come from: memory (decoded before), disk")
      ->delimiter(',')
      ->check(CLI::IsMember({"memory", "disk"}))
      ->capture_default_str();
  command->add_option("--repeat", options->repeat, "Runs of each kind, of which the fastest counts")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--rate", options->rate_hz, "Pace of the camera [Hz]; as fast as it goes when absent")
      ->check(CLI::PositiveNumber);
  command->callback([options, &action] { action = [options] { return sweep(*options); }; });
}

}  // namespace motorcade::perf
