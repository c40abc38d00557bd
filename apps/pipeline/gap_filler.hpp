#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "core/messages.hpp"

namespace motorcade {

/// An input frame that never entered the flow graph.
struct MissedFrame {
  FrameHead head;
  std::int64_t step_ns = 0;  // of a frame out of order: from the frame before, as the camera stamped them
};
/// One that came too late.
inline MissedFrame droppedFrame(FrameId frame, Timestamp stamp) {
  return {.head = {.frame = frame, .stamp = stamp, .status = FrameStatus::kDropped, .cause = FrameCause::kTooLate}};
}

/// Gives a pose to frames that the back-end never saw, so that every input frame has its line in the results. Published
/// poses are predicted at constant velocity. In the final trajectory they are interpolated between neighbors; before
/// the first pose, the first motion is extrapolated backwards. Call it in frame order.
class GapFiller {
 public:
  /// Estimates of frames that came after the last published one and were not processed.
  std::vector<FrameEstimate> fill(const std::vector<MissedFrame>& frames);
  /// Notes a published estimate; `seen_by_backend` is false when the back-end gives no final estimate of the frame.
  void published(const FrameEstimate& online, bool seen_by_backend);
  /// The pose predicted for a moment after the last published frame.
  SE3 predict(Timestamp stamp) const;

  /// Adds the frames that are missing among the back-end's next finals.
  std::vector<FrameEstimate> completed(const std::vector<FrameEstimate>& finals);
  /// Frames that are still missing after the last final.
  std::vector<FrameEstimate> rest();

 private:
  struct Moment {
    Timestamp stamp;
    SE3 T_world_cam;
  };
  /// The last two moments of a trajectory.
  struct Trail {
    std::optional<Moment> before, last;
    void add(const Moment& moment);
    SE3 at(Timestamp stamp) const;
  };

  Trail first_, online_, final_;
  int segment_ = 0;                    // of the last published frame
  std::deque<FrameEstimate> missing_;  // not in the back-end, and not yet final
};

}  // namespace motorcade
