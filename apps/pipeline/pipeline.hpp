#pragma once

#include <memory>
#include <optional>

#include "apps/pipeline/entrance.hpp"
#include "apps/pipeline/gap_filler.hpp"
#include "apps/pipeline/log_callback.hpp"
#include "apps/pipeline/pipeline_params.hpp"
#include "apps/pipeline/pipeline_result.hpp"
#include "apps/pipeline/stages.hpp"
#include "core/messages.hpp"

namespace motorcade {

/// The stages of a run, wired as a flow graph that works on several frames at once. Results do not depend on the number
/// of threads, nor, in replay, on the pace of producer and consumer. One producer thread pushes, one consumer thread
/// takes results. They may be the same thread only under the live policy or when it takes all results before it pushes
/// again.
class Pipeline {
 public:
  Pipeline(const PipelineParams& params, Stages stages, LogCallback log = {});
  /// Abandons what was not finished.
  ~Pipeline();

  /// Producer: pushes a frame and returns its outcome. Frames without an id are numbered. One whose id is not after the
  /// last one's is late and ignored; one whose time is not after the last one's is rejected. If the camera's clock was
  /// set back, times go on from the last one (see `FrameClock`). A frame without a due time is due when the pipeline
  /// takes it. Under the live policy it takes no lock and, with images from an ImagePool, allocates nothing.
  Admission push(StereoFrame frame);
  /// Producer, between two pushes: a captured frame that does not come. It counts as received and dropped.
  void passOver(FrameId frame, Timestamp stamp);
  /// Producer: no further frame comes.
  void close();

  /// Any thread: gives up the frames in flight and ends every wait. No further frame comes.
  void abandon();

  /// Consumer: the next result, waiting for it; empty after the last one of a closed pipeline.
  std::optional<PipelineResult> next();
  /// Consumer: the next result if there is one already.
  std::optional<PipelineResult> poll();
  /// Consumer: closes the input, waits for the frames in flight and ends the run. Call it once, with no `push` under
  /// way. Throws when the run ended before its last frame for a reason that is no frame's: there was no memory to
  /// report a frame.
  PipelineEnd finish();

  /// Any thread: the number of frames so far, and of those that wait on each queue. Does not wait.
  PipelineState state() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace motorcade
