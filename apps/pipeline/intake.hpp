#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "apps/pipeline/entrance.hpp"
#include "apps/pipeline/frame_clock.hpp"
#include "apps/pipeline/gap_filler.hpp"
#include "apps/pipeline/job.hpp"
#include "apps/pipeline/log_callback.hpp"
#include "apps/pipeline/pipeline_params.hpp"
#include "core/mailbox.hpp"
#include "core/messages.hpp"
#include "core/spsc_ring.hpp"

namespace motorcade {

/// The input of frames. The producer's thread pushes them into a ring (replay) or a mailbox (live); the pump takes them
/// and admits them one by one into a free job.
class Intake {
 public:
  Intake(const PipelineParams& params, FreeJobs& free_jobs, Entrance& entrance, LogCallback log);

  /// Producer: see `Pipeline`.
  Admission push(StereoFrame frame);
  void passOver(FrameId frame, Timestamp stamp);
  /// Any thread: no further frame comes.
  void close();

  /// Pump: admits the next frame and returns it. Waits for a free job first and then for a frame, so that in live it is
  /// the newest. Null after the last frame, or when `given_up` says that no job will be free any more.
  Job* next(const std::function<bool()>& given_up);

  /// Counts of frames; valid after the end.
  std::int64_t received() const { return received_.load(); }
  std::int64_t dropped() const { return newest_.overwritten() + passed_over_.load(); }
  std::int64_t refused() const { return refused_.load(); }
  std::int64_t late() const { return late_.load(); }
  /// Frames after the last admitted one that never entered; valid after the end.
  std::vector<MissedFrame> missedAtLast();
  /// Any thread: frames in the ring of replay; live keeps one frame at most.
  std::size_t waiting() const { return input_.size(); }
  std::size_t highWater() const { return input_.highWater(); }

 private:
  bool live() const { return policy_ == InputPolicy::kLive; }
  Admission judge(StereoFrame frame);
  /// A frame on its way in. `turn` counts the frames, this one included, that were or could have been dropped by then.
  struct Entering {
    StereoFrame frame;
    std::int64_t turn = 0;
  };
  Admission enter(StereoFrame frame);
  Admission refuse(const StereoFrame& frame, std::int64_t step_ns, Admission why);
  std::optional<Entering> take();
  void announce(MissedFrame frame);
  void tellOfClock(const StereoFrame& frame);
  void tellOfLost(const Job& job);
  void admit(Job& job, Entering entering);
  std::int64_t droppedUnnamed(const std::vector<MissedFrame>& named, std::int64_t turn);
  std::vector<MissedFrame> missedBefore(FrameId frame);

  InputPolicy policy_;
  FreeJobs& free_jobs_;
  Entrance& entrance_;
  LogCallback log_;

  // Replay uses the ring, live the mailbox. Missed are frames that were passed over or refused. In live they are all
  // frames, to know those that the mailbox lost. If there are too many for the ring, the last of them are missing.
  SpscRing<Entering> input_;
  Mailbox<Entering> newest_;
  SpscRing<MissedFrame> missed_;
  // The producer raises `entering_` before it looks at `closed_`: whoever closed the input waits for a push that came
  // before.
  std::atomic<bool> entering_{false}, closed_{false};
  std::atomic<std::int64_t> received_{0}, passed_over_{0}, refused_{0}, late_{0};

  FrameId next_id_{0};                       // producer only
  std::int64_t turns_ = 0;                   // producer only
  FrameClock clock_;                         // producer only
  std::optional<Timestamp> stamped_;         // producer only: of the frame before, as the camera has it
  std::int64_t told_ahead_ns_ = 0;           // pump only
  std::optional<MissedFrame> missed_ahead_;  // pump only: taken from `missed_`, later than the newest frame
  std::size_t admitted_ = 0;                 // pump only
  std::int64_t last_turn_ = 0;               // pump only: of the last admitted frame
};

}  // namespace motorcade
