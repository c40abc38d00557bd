#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "io/results/frame_table.hpp"

namespace motorcade {

/// Percentiles of a sample by nearest rank; zeros for an empty one.
struct Percentiles {
  double p50 = 0, p95 = 0, p99 = 0, max = 0;
};
Percentiles percentilesOf(std::vector<double> values);

/// A part of a frame's critical path through the pipeline. The parts of a frame add up to its latency.
struct WayPart {
  std::string name;
  double ms = 0;
};

/// The critical path from the moment the pair was due until its result was published: waits and work in turn. Stereo
/// matching and optical flow run side by side, so that the path includes only the one that ended last.
std::vector<WayPart> longestWay(const FrameRow& row);

/// Working time of the stages on a frame, without any waiting. Stereo matching and optical flow run side by side, so
/// that only the longer of the two is added.
double processing_ms(const std::array<double, kStageCount>& work_ms);
double processing_ms(const FrameRow& row);

struct StageLatency {
  std::string name;
  Percentiles work_ms, wait_ms, cpu_ms;
};

/// A slow frame, and the parts of its latency that exceed the median frame's, largest first.
struct SlowFrame {
  FrameRow row;
  std::vector<WayPart> above_median;
};

struct LatencyReport {
  std::size_t frames = 0, dropped = 0, rejected = 0, lost = 0;
  bool has_waits = false;  // false for runs of earlier versions
  Percentiles latency_ms, decode_ms, entry_wait_ms, publish_wait_ms;
  std::vector<StageLatency> stages;
  std::vector<SlowFrame> slowest;
};

/// Reports the latency of the frames that entered the pipeline; the slowest come first.
LatencyReport latencyReport(const std::vector<FrameRow>& rows, std::size_t slowest = 5);

/// A table of at most 100 columns.
std::string latencyTable(const LatencyReport& report);

struct LatencyOptions {
  std::filesystem::path run{}, json{};
};

/// Prints the times of a run's frames by their causes; returns the exit code. Failures are UserErrors.
int runLatency(const LatencyOptions& options);

}  // namespace motorcade
