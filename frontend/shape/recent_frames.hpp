#pragma once

#include <deque>

#include "core/se3.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// The left images of the last few frames, and how the camera moved since each.
class RecentFrames {
 public:
  struct Frame {
    FrameId frame;
    ImagePyramid left;  // but for level 0
    SE3 T_then_now;
  };
  static constexpr std::size_t kMost = 6;

  /// To the next frame, seen or not.
  void move(const SE3& T_previous_now) {
    for (Frame& frame : frames_) frame.T_then_now = frame.T_then_now * T_previous_now;
  }
  /// The frame that was moved to.
  void add(const Features& features) {
    if (features.left.levels.empty()) return;
    Frame& added = frames_.emplace_back(Frame{features.frame->frame, features.left, SE3{}});
    added.left.levels.front() = Image{};
    if (frames_.size() > kMost) frames_.pop_front();
  }
  /// The oldest first.
  const std::deque<Frame>& frames() const { return frames_; }

 private:
  std::deque<Frame> frames_;
};

}  // namespace motorcade
