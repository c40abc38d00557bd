#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include "apps/pipeline/entrance.hpp"
#include "apps/pipeline/log_callback.hpp"
#include "apps/pipeline/stages.hpp"
#include "apps/watch/rig_watch.hpp"
#include "core/messages.hpp"

namespace motorcade {

/// Reason why a pair was not taken; static text. Empty where the reason is not the pair's.
const char* reasonOf(Admission admission);

/// Notices stamps that seem to have another unit: several pairs in a row are too close together, or far apart. Used by
/// the pushing thread only.
class StampDoubts {
 public:
  /// A sentence about a pair that was not taken, once.
  std::optional<std::string> refused(Admission admission, std::int64_t stamp_ns);
  void taken();

 private:
  int untimely_ = 0;
  bool told_ = false;
};

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
