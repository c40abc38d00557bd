#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/gap_filler.hpp"
#include "apps/pipeline/pipeline_params.hpp"
#include "apps/pipeline/stages.hpp"
#include "core/frame_timing.hpp"
#include "core/latency_histogram.hpp"
#include "core/messages.hpp"

namespace motorcade {

enum class LogLevel { kInfo, kWarning, kError };
/// Called from the pipeline's threads, several at once.
using LogCallback = std::function<void(LogLevel, const std::string&)>;

/// One processed or rejected frame, published in frame order. Owns its facts: no image stays alive through it.
struct PipelineResult {
  FrameEstimate online;
  std::vector<FrameEstimate> dropped;  // frames that the live policy dropped just before this one, with predicted poses
  std::vector<FrameEstimate> finals;   // every frame once, in order, when it leaves the smoothing window
  FrameTiming timing;
  SolverCounters counters;
  std::string problem;  // why the frame was rejected or lost, empty when all went well
};

/// The most frames that ever waited in one place.
struct QueueMark {
  std::string name;
  std::int64_t high_water = 0, bound = 0;
};

/// received == processed + dropped + rejected, once the run has ended.
struct PipelineSummary {
  std::int64_t received = 0, processed = 0, dropped = 0, rejected = 0;
  std::int64_t lost = 0;  // of the processed ones: without an ego-motion
  LatencyHistogram latency, latency_with_decoding;
  std::array<LatencyHistogram, kStageCount> stages;
  std::vector<QueueMark> queues;
  SolverCounters solver;
};

struct PipelineEnd {
  std::vector<PipelineResult> results;  // those that nobody had taken
  std::vector<FrameEstimate> finals;    // frames that were still in the window, oldest first
  PipelineSummary summary;
};

/// The stages of a run, wired as a flow graph that works on several frames at once. Results do not depend on the number
/// of threads, nor, in replay, on anybody's pace. One producer thread pushes, one consumer thread takes results; they
/// may be the same thread only under the live policy or when it takes all results before it pushes again.
class Pipeline {
 public:
  Pipeline(const PipelineParams& params, Stages stages, LogCallback log = {});
  /// Abandons what was not finished.
  ~Pipeline();

  /// Producer: false after `close`. Frames without an id are numbered; ids must increase.
  /// A frame without a due time is due when the pipeline takes it.
  /// Under the live policy it takes no lock and, with images from an ImagePool, asks nothing of the heap.
  bool push(StereoFrame frame);
  /// Producer, live only, between two pushes: the camera had this frame, but it was too late to push it. It counts as
  /// received and dropped.
  void passOver(const FrameHeader& frame);
  /// Producer: no further frame comes.
  void close();

  /// Consumer: the next result, waiting for it; empty after the last one of a closed pipeline.
  std::optional<PipelineResult> next();
  /// Consumer: the next result if there is one already.
  std::optional<PipelineResult> poll();
  /// Consumer: closes the input, waits for the frames in flight and ends the run. Call it once, with no `push` under
  /// way.
  PipelineEnd finish();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace motorcade
