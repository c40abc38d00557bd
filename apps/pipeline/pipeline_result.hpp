#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/frame_timing.hpp"
#include "core/latency_histogram.hpp"
#include "core/messages.hpp"

/// Results of a pipeline for its consumer: one per frame, and a summary at the end.
namespace motorcade {

/// One processed or rejected frame, published in frame order. Owns its facts: no image stays alive through it.
struct PipelineResult {
  FrameEstimate online;
  std::vector<FrameEstimate> dropped;  // frames just before this one that never entered, with predicted poses
  std::int64_t dropped_unnamed = 0;    // more of them, where they were thousands: only their number is known
  std::vector<FrameEstimate> finals;   // every frame once, in order, when it leaves the smoothing window
  std::vector<FrameEstimate>
      settled;                    // every frame at most once, in order, as soon as hardly anything will change in it
  std::vector<ObjectMask> masks;  // of the online estimate's objects, those whose outline was looked for
  FrameMeasurementsPtr measurements;  // what the estimates were made from
  FrameTiming timing;
  SolverCounters counters;
  std::string problem;  // why the frame was rejected or lost, empty when all went well
};

/// The most frames that ever waited in one queue.
struct QueueMark {
  std::string name;
  std::int64_t high_water = 0, bound = 0;
};

/// The frames that wait in one queue at this moment.
struct QueueDepth {
  std::string name;
  std::int64_t waiting = 0, bound = 0;
};

/// Progress of a pipeline while it works.
struct PipelineState {
  std::int64_t received = 0;
  std::vector<QueueDepth> queues;  // in the order of the data
};

/// received == processed + dropped + rejected, once the run has ended. Frames that came late are in none of them.
struct PipelineSummary {
  std::int64_t received = 0, processed = 0, dropped = 0, rejected = 0;
  std::int64_t late = 0;                           // pushed after a frame with a higher id, and ignored
  std::int64_t lost = 0;                           // of the processed ones: without an ego-motion
  std::int64_t degraded = 0;                       // of the others: measured, but less surely
  std::array<std::int64_t, kCauseCount> causes{};  // frames by FrameCause
  std::int64_t segments = 0;
  LatencyHistogram latency, latency_with_decoding;
  LatencyHistogram entry_wait;  // see FrameTiming, as for the next ones
  std::array<LatencyHistogram, kStageCount> stages, waits, cpu;
  std::vector<QueueMark> queues;
  SolverCounters solver;
};

struct PipelineEnd {
  std::vector<PipelineResult> results;  // those that were not taken before
  std::vector<FrameEstimate> dropped;   // frames after the last result that never entered, with predicted poses
  std::vector<FrameEstimate> finals;    // frames that were still in the window, oldest first
  PipelineSummary summary;
};

/// Follows a run while it goes on, to show it or to write a file of its own. Neither call may wait. Only the second may
/// in a replay that has to wait for a writer.
class RunListener {
 public:
  virtual ~RunListener() = default;
  /// Called on the thread of the replay when a pair has gone into the pipeline. Its images belong to a pool; keep few
  /// of them.
  virtual void frameEntered(const StereoFrame& frame) = 0;
  /// Called on the thread that takes the results, in frame order.
  virtual void frameLeft(const PipelineResult& result) = 0;
};

/// The listeners of a run, which owns none of them.
using RunListeners = std::vector<RunListener*>;

}  // namespace motorcade
