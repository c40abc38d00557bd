#pragma once

#include <deque>
#include <mutex>
#include <string>

#include "apps/pipeline/log_callback.hpp"
#include "apps/pipeline/stages.hpp"
#include "apps/watch/rig_watch.hpp"
#include "core/messages.hpp"

namespace motorcade {

/// Looks at a tracker's pairs when their results are out, so that no result waits for it. It logs faults of the rig and
/// changes of it.
class PairWatch {
 public:
  PairWatch(const StereoCamera& camera, LogCallback log) : watch_(camera), log_(std::move(log)) {}

  /// The same stages, but they also leave each pair here. The watch outlives them.
  Stages watched(Stages stages);
  /// Looks at the pairs up to that of this frame. Called by one thread, in the order of the frames.
  void look(FrameId frame);
  /// Reason why results are worthless now; empty if they are not. Call it on the thread that looks.
  const std::string& problem() const { return problem_; }

 private:
  StereoFramePtr next(FrameId frame);
  void observe(const StereoFrame& pair);

  RigWatch watch_;
  LogCallback log_;
  std::string problem_;
  std::mutex mutex_;
  std::deque<StereoFramePtr> waiting_;  // no more than frames in flight
};

}  // namespace motorcade
