#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "io/results/frame_table.hpp"

namespace motorcade {

/// Of a sample, by nearest rank; zeros of none.
struct Percentiles {
  double p50 = 0, p95 = 0, p99 = 0, max = 0;
};
Percentiles percentilesOf(std::vector<double> values);

/// A stretch of the longest way of a frame through the pipeline. The stretches of a frame add up to its latency.
struct WayPart {
  std::string name;
  double ms = 0;
};

/// From the moment the pair was due until its result was published: waiting and working by turns. Of stereo matching
/// and optical flow, which run side by side, the way leads over the one that ended last.
std::vector<WayPart> longestWay(const FrameRow& row);

/// Time that the stages worked on a frame, without any waiting: the sum of all, of stereo matching and optical flow,
/// which run side by side, the longer.
double processing_ms(const std::array<double, kStageCount>& work_ms);
double processing_ms(const FrameRow& row);

struct StageLatency {
  std::string name;
  Percentiles work_ms, wait_ms, cpu_ms;
};

/// A frame that took long, and what of that lies above the median frame, largest first.
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

/// Of the frames that entered the pipeline; the slowest come first.
LatencyReport latencyReport(const std::vector<FrameRow>& rows, std::size_t slowest = 5);

}  // namespace motorcade
