#include "perf/apps/overload.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "perf/apps/bench_options.hpp"
#include "perf/apps/playback.hpp"

namespace motorcade::perf {
namespace {

constexpr int kExitUnaccounted = 1;

struct OverloadOptions {
  BenchOptions bench;
  std::vector<int> factors{2, 5};
  double seconds = 20, stall_s = 2;
};

/// Capacity of the pipeline without overload.
struct Capacity {
  double rate_hz = 0;        // of pairs that enter as soon as there is room
  double processing_ms = 0;  // p99 of the latency at a quarter of that rate: what a frame takes that meets no other
};

enum class Stalling { kMotionStage, kConsumer };

std::size_t framesIn(double seconds, double rate_hz) {
  return std::max<std::size_t>(20, static_cast<std::size_t>(seconds * rate_hz));
}

/// A drive seen by a camera `factor` times as fast: each image is shown so many times.
HeldDrive seenFaster(const OverloadOptions& options, std::size_t frames, std::size_t factor) {
  BenchOptions bench = options.bench;
  bench.frames = frames / factor + 1;
  const Sequence drive = driveOf(bench);
  Sequence faster = drive;
  faster.frames.clear();
  faster.stamps.clear();
  for (std::size_t index = 0; index < frames; ++index) {
    const std::int64_t now_ns = drive.stamps[index / factor].ns;
    const std::int64_t next_ns =
        index / factor + 1 < drive.stamps.size() ? drive.stamps[index / factor + 1].ns : now_ns + 100'000'000;
    faster.frames.push_back(drive.frames[index / factor]);
    faster.stamps.push_back(
        {now_ns + (next_ns - now_ns) * static_cast<std::int64_t>(index % factor) / static_cast<std::int64_t>(factor)});
  }
  return HeldDrive(faster);
}

/// Stages of which scene flow segmentation takes `pause` longer in one frame.
Stages withStall(Stages stages, FrameId frame, std::chrono::duration<double> pause) {
  stages.scene_flow_segmentation = [segment = std::move(stages.scene_flow_segmentation), frame, pause, done = false](
                                       const StereoMatchesPtr& stereo, const OpticalFlowPtr& flow) mutable {
    if (!done && flow->features->frame->head.frame >= frame) {
      done = true;
      std::this_thread::sleep_for(pause);
    }
    return segment(stereo, flow);
  };
  return stages;
}

class OverloadBench {
 public:
  explicit OverloadBench(const OverloadOptions& options)
      : options_(options), live_(configOf(options.bench)), camera_(driveOf(options.bench).camera) {
    live_.pipeline.policy = InputPolicy::kLive;
  }

  /// Runs all measurements; false when frames are unaccounted for.
  bool run() {
    measureCapacity();
    bool accounted = true;
    std::printf("\n%-22s | %8s %9s %8s %8s | %7s %7s %7s %7s | %12s\n", "camera", "received", "processed", "dropped",
                "rejected", "p50 ms", "p95", "p99", "max", "p99 at most");
    for (const int factor : options_.factors) accounted = overload(factor) && accounted;
    for (const Stalling stalling : {Stalling::kMotionStage, Stalling::kConsumer})
      accounted = stall(stalling) && accounted;
    return accounted;
  }

 private:
  void measureCapacity() {
    PipelineConfig replay = configOf(options_.bench);
    const HeldDrive drive = seenFaster(options_, 200, 1);
    const auto fast = play(*playHeld(drive), replay, makeStages(replay, camera_));
    capacity_.rate_hz = fast.rate_hz();
    const auto slow =
        play(*playHeld(drive), live_, makeStages(live_, camera_), {.rate_hz = capacity_.rate_hz / 4, .observer = {}});
    const LatencyHistogram& latency = slow.summary.latency;
    capacity_.processing_ms = latency.percentile_ms(0.99);
    std::printf("%s, %d threads: %.1f frames/s as fast as it goes; alone a frame takes p50 %.1f ms, p99 %.1f ms\n",
                options_.bench.sequence.c_str(), live_.pipeline.threads, capacity_.rate_hz, latency.percentile_ms(0.5),
                capacity_.processing_ms);
  }

  /// Bound of the latency: two periods of the camera and the time that a frame takes alone.
  double bound_ms(double camera_hz) const { return 2e3 / camera_hz + capacity_.processing_ms; }

  bool overload(int factor) const {
    const double camera_hz = factor * capacity_.rate_hz;
    const HeldDrive drive =
        seenFaster(options_, framesIn(options_.seconds, camera_hz), static_cast<std::size_t>(factor));
    const auto run = play(*playHeld(drive), live_, makeStages(live_, camera_), {.rate_hz = camera_hz, .observer = {}});
    return report(std::to_string(factor) + " x", camera_hz, run);
  }

  /// Plays at half the rate, with a pause in the middle.
  bool stall(Stalling stalling) const {
    constexpr double kSecondsAround = 2;
    const double camera_hz = capacity_.rate_hz / 2;
    const HeldDrive drive = seenFaster(options_, framesIn(2 * kSecondsAround + options_.stall_s, camera_hz), 1);
    const FrameId stalled{static_cast<std::int64_t>(kSecondsAround * camera_hz)};
    const std::chrono::duration<double> pause(options_.stall_s);
    Stages stages = makeStages(live_, camera_);
    if (stalling == Stalling::kMotionStage) stages = withStall(std::move(stages), stalled, pause);

    std::vector<double> latencies_ms;  // from the stall on
    const auto observer = [&](const PipelineResult& result) {
      if (result.online.head.frame < stalled) return;
      if (stalling == Stalling::kConsumer && latencies_ms.empty()) std::this_thread::sleep_for(pause);
      latencies_ms.push_back(result.timing.latency_ms());
    };
    const auto run = play(*playHeld(drive), live_, std::move(stages), {.rate_hz = camera_hz, .observer = observer});
    const bool accounted = report(
        stalling == Stalling::kConsumer ? "0.5 x, consumer stalls" : "0.5 x, segmentation stalls", camera_hz, run);
    std::printf("    from the stall on:");
    for (std::size_t i = 0; i < std::min<std::size_t>(latencies_ms.size(), 12); ++i)
      std::printf(" %.0f", latencies_ms[i]);
    const double limit_ms = bound_ms(camera_hz);
    std::printf(" ms; %lld above %.0f ms\n",
                static_cast<long long>(std::ranges::count_if(latencies_ms, [&](double ms) { return ms > limit_ms; })),
                limit_ms);
    return accounted;
  }

  bool report(const std::string& name, double camera_hz, const Playback& run) const {
    const PipelineSummary& summary = run.summary;
    const bool accounted = summary.received == summary.processed + summary.dropped + summary.rejected;
    std::printf("%-22s | %8lld %9lld %8lld %8lld | %7.1f %7.1f %7.1f %7.1f | %12.1f%s\n", name.c_str(),
                static_cast<long long>(summary.received), static_cast<long long>(summary.processed),
                static_cast<long long>(summary.dropped), static_cast<long long>(summary.rejected),
                summary.latency.percentile_ms(0.5), summary.latency.percentile_ms(0.95),
                summary.latency.percentile_ms(0.99), summary.latency.max_ms(), bound_ms(camera_hz),
                accounted ? "" : "  FRAMES ARE UNACCOUNTED FOR");
    std::fflush(stdout);
    return accounted;
  }

  OverloadOptions options_;
  PipelineConfig live_;
  StereoCamera camera_;
  Capacity capacity_;
};

}  // namespace

void addOverload(CLI::App& app, std::function<int()>& action) {
  const auto options = std::make_shared<OverloadOptions>();
  CLI::App* command = app.add_subcommand("overload", "The live policy when the camera is too fast, and after stalls");
  addBenchOptions(*command, options->bench);
  command->add_option("--factors", options->factors, "Rates of the camera, in processing rates")
      ->delimiter(',')
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_option("--seconds", options->seconds, "Duration of each overload")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--stall", options->stall_s, "Duration of the stalls [s]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->callback(
      [options, &action] { action = [options] { return OverloadBench(*options).run() ? 0 : kExitUnaccounted; }; });
}

}  // namespace motorcade::perf
