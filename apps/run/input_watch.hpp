#pragma once

#include <vector>

#include "apps/watch/rig_watch.hpp"
#include "core/messages.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// Looks at the pairs of a run as they enter, and logs each fault once.
class InputWatch {
 public:
  /// Creates a watch; with `force` the run goes on even if its results would be worthless.
  InputWatch(const StereoCamera& camera, bool force) : watch_(camera), force_(force) {}

  /// Takes the pairs in order. Returns false as soon as results are known to be worthless.
  bool admits(const StereoFrame& pair);
  /// Logs the findings if the run ended before enough pairs were seen; call it after the last pair.
  void finish() { tell(watch_.finish()); }
  /// True when the run was, or should have been, ended.
  bool refused() const { return refused_; }
  /// All findings, in the order of the frames.
  const std::vector<RigFinding>& found() const { return found_; }

 private:
  void tell(const std::vector<RigFinding>& found);

  RigWatch watch_;
  bool force_;
  bool refused_ = false;
  std::vector<RigFinding> found_;
};

}  // namespace motorcade
