#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/pipeline_result.hpp"
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

/// Counts the good frames of a run, and keeps the reason why others are not good.
class FollowedFrames {
 public:
  void observe(const PipelineResult& result);
  std::int64_t count() const { return count_; }
  /// True when no motion was measured although there were frames. The first frame alone has none, and is good all the
  /// same.
  bool none(const PipelineSummary& summary) const;
  /// A sentence on such a run: the number of frames, the outcome of most of them, and the reason for the first of
  /// those.
  std::string whyNone(const PipelineSummary& summary) const;

 private:
  std::int64_t count_ = 0;
  std::array<std::string, kCauseCount> first_problems_;
};

/// Watches for an impossible drive. Times in another unit than seconds, or a wrong rate, make the camera faster than
/// any car, or its pairs too far apart to follow anything.
class Plausibility {
 public:
  /// Takes the online estimates in order. Returns a sentence that says what is not plausible and how to mend it, one of
  /// each kind.
  std::optional<std::string> observe(const FrameEstimate& online);

 private:
  /// Frames in a row in which a condition holds; true when it has held long enough, once.
  class Persistent {
   public:
    bool observe(bool holds);

   private:
    int frames_ = 0;
    bool told_ = false;
  };

  struct Seen {
    Timestamp stamp;
    FrameStatus status;
    SE3 T_world_cam;
  };
  std::optional<Seen> before_;
  Persistent far_apart_, close_together_, too_fast_;
};

}  // namespace motorcade
