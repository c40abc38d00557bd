#pragma once

#include <array>
#include <chrono>
#include <functional>
#include <optional>

#include "apps/pipeline/configuration.hpp"
#include "apps/pipeline/pipeline.hpp"
#include "apps/run/process_usage.hpp"
#include "core/stereo_camera.hpp"
#include "perf/apps/bench_drive.hpp"
#include "perf/apps/result_digest.hpp"

namespace motorcade::perf {

/// Costs and results of one playback of a drive through the pipeline.
struct Playback {
  PipelineSummary summary;
  ResultDigests digests;
  LatencyHistogram in_pipeline;  // from admission to publication, whenever the pair was due
  std::array<double, kStageCount> stage_cpu_ms{}, stage_wall_ms{};  // summed over the frames
  double wall_s = 0;                                                // from the first pair to the last result
  ProcessUsage used;  // of the whole process, decoding included, in that time

  std::int64_t frames() const { return summary.processed + summary.rejected; }
  double rate_hz() const { return static_cast<double>(frames()) / wall_s; }
  /// `total` divided by the number of frames.
  double perFrame(double total) const { return total / static_cast<double>(frames()); }
};

struct PlaybackOptions {
  /// Pairs per second of a camera that does not wait for the pipeline. Empty: each pair enters as soon as there is
  /// room, and is due then.
  std::optional<double> rate_hz;
  /// Called with each result, on the thread that takes them.
  std::function<void(const PipelineResult&)> observer;
};

/// Plays a drive through the pipeline of `motorcade run`, from a thread of its own.
Playback play(FrameSource& source, const PipelineConfig& config, Stages stages, const PlaybackOptions& options = {});

}  // namespace motorcade::perf
